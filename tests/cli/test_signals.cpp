#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "cli/models.h"
#include "cli/run_tool.h"

namespace lambake::test {
namespace {

/// Starts the tool. @param prepare  called in the new process.
template <typename Prepare>
pid_t start_tool(const ScratchFolder& scratch, const std::string& arguments, const Prepare& prepare) {
  const std::string command = "exec '" LAMBAKE_TOOL "' " + arguments;
  const pid_t child = ::fork();
  if (child != 0) return child;
  for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGPIPE}) ::signal(signal, SIG_DFL);
  prepare();
  if (::chdir(scratch.path().c_str()) == 0)
    ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
  ::_exit(127);
}

/// Its status at the end, which is that of a kill if it has not come to it within a minute.
int status_of(pid_t child) {
  int status = -1;
  for (int i = 0; i < 60000; ++i) {
    if (::waitpid(child, &status, WNOHANG) == child) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ::kill(child, SIGKILL);
  return ::waitpid(child, &status, 0) == child ? status : -1;
}

// Long enough that a signal comes in between.
constexpr const char* long_compare = "compare in.off -o out --sun 0.3,0.2,1 --size 2000x2000 --quiet";

/// @returns whether there is something on its way to the output within a minute.
bool wait_for_temporary(const ScratchFolder& scratch) {
  for (int i = 0; i < 60000; ++i) {
    for (const auto& entry : std::filesystem::directory_iterator(scratch.path()))
      if (entry.path().filename().string().starts_with(".lambake-")) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

std::size_t n_entries(const ScratchFolder& scratch) {
  const std::filesystem::recursive_directory_iterator all(scratch.path());
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

TEST(Signals, ThatEndIt_LeaveNothingBehind) {
  for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
    const ScratchFolder folder("signals");
    write_octahedron(folder / "in.off");
    const pid_t child = start_tool(folder, long_compare, [] {});
    ASSERT_GT(child, 0);
    EXPECT_TRUE(wait_for_temporary(folder));
    ::kill(child, signal);
    const int status = status_of(child);
    ASSERT_TRUE(WIFSIGNALED(status)) << signal;
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_EQ(n_entries(folder), 1U) << signal;
  }
}

TEST(Signals, ThatNohupIgnores_DoNotEndIt) {
  const ScratchFolder folder("ignored_signals");
  write_octahedron(folder / "in.off");
  const pid_t child = start_tool(folder, long_compare, [] { ::signal(SIGHUP, SIG_IGN); });
  ASSERT_GT(child, 0);
  EXPECT_TRUE(wait_for_temporary(folder));
  ::kill(child, SIGHUP);
  const int status = status_of(child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/index.html"));
}

TEST(Signals, AClosedPipe_IsAnErrorOfWriting) {
  const ScratchFolder folder("closed_pipe");
  write_octahedron(folder / "in.off");
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  const pid_t child = start_tool(folder, "info in.off 2>err", [&] {
    ::dup2(ends[1], STDOUT_FILENO);
    ::close(ends[1]);
  });
  ::close(ends[1]);
  ASSERT_GT(child, 0);
  const int status = status_of(child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3);
  EXPECT_NE(read_bytes(folder / "err").find("standard output"), std::string::npos);
}

}  // namespace
}  // namespace lambake::test
