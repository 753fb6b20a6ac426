// Another program, fed through its standard input.
#pragma once

#include <string>
#include <sys/types.h>
#include <vector>

namespace shots {

class ChildProcess {
  public:
    /// Starts words[0], found on PATH, without a shell. Throws Error(Failed) where it is not installed; `remedy` ends
    /// that message.
    ChildProcess(const std::vector<std::string>& words, const std::string& remedy);

    /// Closes the input and waits, if finish() has not.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Hands over all bytes. A child that has stopped reading is told by finish().
    void write(const std::string& bytes);

    /// Closes the input and waits for the end. Throws Error(Failed) with what the child wrote on its standard error,
    /// where it failed.
    void finish();

  private:
    /// Status as waitpid() tells it; the child is gone then.
    int wait();

    std::string name_;
    pid_t pid_ = -1;
    int input_ = -1;     // the writing end of its standard input
    int messages_ = -1;  // a nameless file with its standard error
};

}  // namespace shots
