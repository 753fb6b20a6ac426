#include "shots/stages/interruption.h"

#include "assets/base/error.h"

#include <csignal>

namespace shots {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void note_interruption(int) {
    interrupted = 1;
}

}  // namespace

void catch_interruptions() {
    struct sigaction action = {};
    action.sa_handler = note_interruption;
    action.sa_flags =
        SA_RESTART | static_cast<int>(SA_RESETHAND);  // the second signal acts as usual
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

void stop_if_interrupted() {
    if (interrupted)
        throw assets::Error(assets::ErrorKind::Interrupted,
                            "interrupted; every frame that was done is saved, and the same "
                            "command goes on from there");
}

}  // namespace shots
