// Errors that reach the user. Libraries throw; only main prints and turns the kind into an exit code.
#pragma once

#include <stdexcept>
#include <string>

namespace assets {

/// What went wrong, as the exit codes of the program tell it apart.
enum class ErrorKind {
    Failed = 1,        // could not do it, for no fault of the input
    Input = 2,         // bad usage, shot file or mesh
    Diverged = 3,      // a step could not be solved: retrying will not help
    Resources = 4,     // out of memory or disk
    Interrupted = 75,  // stopped by a signal with a checkpoint saved: retry resumes
};

/// A message for the user: what was found, what is allowed, what to do.
class Error : public std::runtime_error {
  public:
    /// `key` is the dotted path of the shot file's word at fault ("body.bar.region.soft.select"),
    /// empty where no word is: shots/ turns it into file:line:column.
    Error(ErrorKind kind, const std::string& message, std::string key = {});

    ErrorKind kind() const { return kind_; }

    const std::string& key() const { return key_; }

  private:
    ErrorKind kind_;
    std::string key_;
};

/// Throws std::logic_error unless `condition`, which `what` tells in words: for faults of ours, in Release too.
void check(bool condition, const char* what);

}  // namespace assets
