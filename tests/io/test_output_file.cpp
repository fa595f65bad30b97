#include "lambake/io/output_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "lambake/core/error.h"

namespace lambake {
namespace {

namespace fs = std::filesystem;

class OutputFiles : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::size_t n_files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  static std::string content(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  const fs::path folder_ = fs::temp_directory_path() / ("lambake-test-output-" + std::to_string(::getpid()));
  const fs::path path_ = folder_ / "out.ply";
};

TEST_F(OutputFiles, Committed_IsThereWhole_AndAlone) {
  OutputFile file(path_.string());
  file.write("solid ");
  file.write("\0\xff", 2);
  EXPECT_FALSE(fs::exists(path_));
  file.commit();
  EXPECT_EQ(content(path_), std::string("solid \0\xff", 8));
  EXPECT_EQ(n_files(), 1U);
}

TEST_F(OutputFiles, NotCommitted_LeavesNothing) {
  { OutputFile(path_.string()).write("half of it"); }
  EXPECT_EQ(n_files(), 0U);
}

TEST_F(OutputFiles, NotCommitted_LeavesWhatWasThereBefore) {
  std::ofstream(path_) << "earlier";
  { OutputFile(path_.string()).write("half of it"); }
  EXPECT_EQ(content(path_), "earlier");
  EXPECT_EQ(n_files(), 1U);
}

TEST_F(OutputFiles, Committed_ReplacesWhatWasThereBefore) {
  std::ofstream(path_) << "earlier and longer";
  OutputFile file(path_.string());
  file.write("now");
  file.commit();
  EXPECT_EQ(content(path_), "now");
}

TEST_F(OutputFiles, TemporaryName_IsInTheSameFolder) {
  const OutputFile file(path_.string());
  EXPECT_EQ(fs::path(file.temporary_path()).parent_path(), folder_);
}

TEST_F(OutputFiles, FolderThatIsNotThere_IsAnErrorThatNamesTheFile) {
  const std::string path = (folder_ / "none" / "out.ply").string();
  try {
    OutputFile file(path);
    ADD_FAILURE();
  } catch (const IoError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(path + ": cannot be written: ", 0), 0U) << error.what();
  }
}

TEST_F(OutputFiles, PlaceTakenByAFolderOrPipe_IsAnError_AndLeavesNothing) {
  fs::create_directories(path_ / "inside");
  EXPECT_THROW(OutputFile(path_.string()), IoError);
  const fs::path pipe = folder_ / "pipe.ply";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(OutputFile(pipe.string()), IoError);
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(n_files(), 2U);
}

TEST_F(OutputFiles, SymbolicLink_StaysAndLeadsToTheNewFile) {
  fs::create_directory(folder_ / "elsewhere");
  const fs::path target = folder_ / "elsewhere" / "real.ply";
  std::ofstream(target) << "earlier";
  fs::create_symlink("elsewhere/real.ply", path_);
  write_file(path_.string(), "now");
  EXPECT_TRUE(fs::is_symlink(path_));
  EXPECT_EQ(content(target), "now");
  // One that leads nowhere yet, by another link.
  const fs::path by = folder_ / "by.ply";
  fs::remove(target);
  fs::create_symlink("out.ply", by);
  write_file(by.string(), "new");
  EXPECT_TRUE(fs::is_symlink(by));
  EXPECT_TRUE(fs::is_symlink(path_));
  EXPECT_EQ(content(target), "new");
}

TEST_F(OutputFiles, FullDisk_IsAnErrorAtTheLatestWhenCommitted) {
  // /dev/full refuses every byte: a link in the place of the temporary file leads the bytes there.
  const std::string temporary = [&] { return OutputFile(path_.string()).temporary_path(); }();
  fs::create_symlink("/dev/full", temporary);
  OutputFile file(path_.string());
  EXPECT_THROW(
      {
        file.write(std::string(1 << 20, 'x'));
        file.commit();
      },
      IoError);
  EXPECT_FALSE(fs::exists(path_));
}

}  // namespace
}  // namespace lambake
