#include "shots/stages/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/core.h>
#include <iostream>
#include <string_view>
#include <unistd.h>

namespace shots {
namespace {

constexpr int bar_width = 24;
constexpr double seconds_per_show = 0.2;

double seconds_between(std::chrono::steady_clock::time_point from,
                       std::chrono::steady_clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
}

}  // namespace

ProgressStyle progress_style(bool quiet) {
    if (quiet)
        return ProgressStyle::Quiet;
    const char* terminal = std::getenv("TERM");
    const bool rewrites = terminal != nullptr && std::string_view(terminal) != "dumb";
    return rewrites && ::isatty(STDERR_FILENO) ? ProgressStyle::Bar : ProgressStyle::Lines;
}

Progress::Progress(ProgressStyle style) : Progress(style, std::cerr) {}

Progress::Progress(ProgressStyle style, std::ostream& out) : style_(style), out_(out) {}

Progress::~Progress() {
    finish();
}

void Progress::start(const std::string& name, int total, int done) {
    finish();
    name_ = name;
    label_.clear();
    total_ = total;
    done_ = done_before_ = done;
    share_ = 0;
    started_ = last_ = Clock::now();
    if (style_ == ProgressStyle::Bar)
        show_bar(started_);
}

void Progress::advance(const std::string& label) {
    const auto now = Clock::now();
    const double elapsed = seconds_between(started_, now);
    const double latest = seconds_between(last_, now);
    last_ = now;
    label_ = label;
    ++done_;
    share_ = 0;
    if (style_ == ProgressStyle::Bar)
        show_bar(now);
    if (style_ == ProgressStyle::Lines) {
        const double each = elapsed / (done_ - done_before_);
        out_ << fmt::format("{} {} ({}/{}): {:.3f} s, {}, {} left\n",
                            name_,
                            label,
                            done_,
                            total_,
                            latest,
                            rate_text(each),
                            duration_text(each * (total_ - done_)))
             << std::flush;
    }
}

void Progress::reach(double share) {
    const auto now = Clock::now();
    if (style_ != ProgressStyle::Bar || seconds_between(shown_, now) < seconds_per_show)
        return;
    share_ = std::clamp(share, 0.0, 1.0);
    show_bar(now);
}

void Progress::say(const std::string& message) {
    finish();
    if (style_ != ProgressStyle::Quiet)
        out_ << message << '\n' << std::flush;
}

void Progress::finish() {
    if (shown_width_ > 0)
        out_ << '\n' << std::flush;
    shown_width_ = 0;
}

void Progress::show_bar(Clock::time_point now) {
    const double reached = done_ + share_;
    const int filled = total_ > 0 ? static_cast<int>(bar_width * reached / total_) : bar_width;
    std::string line = fmt::format("{} [{:.<{}}] {}/{}",
                                   name_,
                                   std::string(static_cast<std::size_t>(filled), '#'),
                                   bar_width,
                                   done_,
                                   total_);
    if (share_ > 0)
        line += fmt::format(" + {:.0f}%", std::floor(100 * share_));
    if (reached > done_before_) {
        const double each = seconds_between(started_, now) / (reached - done_before_);
        line += fmt::format("  {}{}{}  {} left",
                            label_,
                            label_.empty() ? "" : "  ",
                            rate_text(each),
                            duration_text(each * (total_ - reached)));
    }
    shown_ = now;
    // Blanks cover what a longer line has left on the screen.
    const int width = static_cast<int>(line.size());
    line.append(static_cast<std::size_t>(std::max(0, shown_width_ - width)), ' ');
    out_ << '\r' << line << std::flush;
    shown_width_ = width;
}

std::string rate_text(double seconds_per_item) {
    if (seconds_per_item <= 0)
        return "- frames/s";
    if (seconds_per_item < 1)
        return fmt::format("{:.3g} frames/s", 1 / seconds_per_item);
    return fmt::format("{:.3g} s/frame", seconds_per_item);
}

std::string duration_text(double seconds) {
    const long whole = std::lround(std::ceil(seconds));
    if (whole < 60)
        return fmt::format("{} s", whole);
    if (whole < 3600)
        return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace shots
