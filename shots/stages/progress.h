// How far a stage has come, told on stderr: stdout belongs to results.
#pragma once

#include <chrono>
#include <iosfwd>
#include <string>

namespace shots {

enum class ProgressStyle {
    Quiet,  // nothing
    Lines,  // one line per item: pipes and log files
    Bar     // one line that rewrites itself: terminals
};

/// Bar where stderr is a terminal that can rewrite a line, Lines where it is not; Quiet where `quiet` asks for it.
ProgressStyle progress_style(bool quiet);

/// Counts the items (frames) of one stage after the other. Not for use from several threads at once.
class Progress {
  public:
    explicit Progress(ProgressStyle style);  // on stderr
    Progress(ProgressStyle style, std::ostream& out);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Begins a stage of `total` items, `done` of which are there already and do not count for the rate.
    void start(const std::string& name, int total, int done = 0);

    /// One more item is done; `label` names it ("frame 1001").
    void advance(const std::string& label);

    /// A share of the next item is done, 0 to 1; shown from time to time where the style is Bar.
    void reach(double share);

    /// A line of its own, without spoiling the bar: notes for the user. Nothing where Quiet.
    void say(const std::string& message);

    /// Ends the bar's line, if there is one. Starting the next stage and the destructor do the same.
    void finish();

  private:
    using Clock = std::chrono::steady_clock;

    void show_bar(Clock::time_point now);

    ProgressStyle style_;
    std::ostream& out_;
    std::string name_;
    std::string label_;  // of the last item
    int total_ = 0, done_ = 0, done_before_ = 0;
    double share_ = 0;  // of the next one
    Clock::time_point started_, last_, shown_;
    int shown_width_ = 0;  // of the bar's line on the screen now
};

/// "12.3 frames/s" or, where slower than one a second, "4.2 s/frame".
std::string rate_text(double seconds_per_item);

/// "8 s", "3 min 20 s", "2 h 05 min".
std::string duration_text(double seconds);

}  // namespace shots
