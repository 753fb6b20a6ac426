#include "shots/stages/child_process.h"

#include "assets/base/error.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

extern char**
    environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to the program

namespace shots {
namespace {

[[noreturn]] void fail(const std::string& message) {
    throw assets::Error(assets::ErrorKind::Failed, message);
}

std::string content_of(int file) {
    std::string text(static_cast<std::size_t>(std::max<off_t>(lseek(file, 0, SEEK_END), 0)),
                     '\0');
    const ssize_t n = pread(file, text.data(), text.size(), 0);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
    return text;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words, const std::string& remedy)
    : name_(words.front()) {
    int ends[2];
    messages_ = memfd_create("messages", MFD_CLOEXEC);
    if (messages_ < 0 || pipe2(ends, O_CLOEXEC) != 0)
        fail(fmt::format("cannot start {}: {}", name_, std::strerror(errno)));
    std::signal(SIGPIPE,
                SIG_IGN);  // a child that dies makes write() fail instead of killing us

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, messages_, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, messages_, STDERR_FILENO);
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (const std::string& word : words)
        arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const int error =
        posix_spawnp(&pid_, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    input_ = ends[1];
    if (error != 0) {
        pid_ = -1;
        wait();
        close(messages_);
        fail(error == ENOENT ? fmt::format("{} is not installed: {}", name_, remedy)
                             : fmt::format("cannot start {}: {}", name_, std::strerror(error)));
    }
}

ChildProcess::~ChildProcess() {
    wait();
    close(messages_);
}

void ChildProcess::write(const std::string& bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t n = ::write(input_, bytes.data() + done, bytes.size() - done);
        if (n > 0)
            done += static_cast<std::size_t>(n);
        else if (errno != EINTR)
            return;
    }
}

int ChildProcess::wait() {
    if (input_ >= 0)
        close(input_);
    input_ = -1;
    int status = 0;
    while (pid_ > 0 && waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
}

void ChildProcess::finish() {
    const int status = wait();
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
        return;
    fail(fmt::format("{} failed ({}): {}",
                     name_,
                     WIFSIGNALED(status) ? fmt::format("signal {}", WTERMSIG(status))
                                         : fmt::format("exit code {}", WEXITSTATUS(status)),
                     content_of(messages_)));
}

}  // namespace shots
