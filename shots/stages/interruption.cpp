#include "shots/stages/interruption.h"

#include "assets/base/error.h"

#include <csignal>

namespace shots {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void note_interruption(int) {
    interrupted = 1;
    for (const int number : {SIGINT, SIGTERM})  // the second one acts as usual
        std::signal(number, SIG_DFL);
}

}  // namespace

void catch_interruptions() {
    struct sigaction action = {};
    action.sa_handler = note_interruption;
    action.sa_flags = SA_RESTART;
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
