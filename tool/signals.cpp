#include "signals.h"

#include <signal.h>
#include <unistd.h>

#include <system_error>
#include <thread>

#include "lambake/io/temporary.h"

namespace lambake::tool {

void prepare_for_signals() {
  ::signal(SIGPIPE, SIG_IGN);
  sigset_t endings;
  ::sigemptyset(&endings);
  for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler != SIG_IGN) ::sigaddset(&endings, signal);  // Else it is run by nohup, or behind.
  }
  ::pthread_sigmask(SIG_BLOCK, &endings, nullptr);  // For the threads to come too.
  const auto wait = [endings] {
    int signal = 0;
    ::sigwait(&endings, &signal);
    remove_temporaries();
    ::pthread_sigmask(SIG_UNBLOCK, &endings, nullptr);
    ::kill(::getpid(), signal);
  };
  try {
    std::thread(wait).detach();
  } catch (const std::system_error&) {  // No thread is to be had: signals end it as they do without us.
    ::pthread_sigmask(SIG_UNBLOCK, &endings, nullptr);
  }
}

}  // namespace lambake::tool
