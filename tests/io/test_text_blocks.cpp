#include "lambake/io/text_blocks.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "lambake/core/error.h"

namespace lambake {
namespace {

class TextBlocksTest : public testing::Test {
 protected:
  ~TextBlocksTest() override { std::filesystem::remove(path); }

  void write(const std::string& text) const { std::ofstream(path, std::ios::binary) << text; }
  static std::vector<std::string> blocks_of(TextBlocks& blocks) {
    std::vector<std::string> all;
    for (std::span<char> block; !(block = blocks.next()).empty();)
      all.emplace_back(block.begin(), block.end());
    return all;
  }

  // Tests may run at the same time.
  std::string path = std::string(testing::TempDir()) + "lambake_" +
                     testing::UnitTest::GetInstance()->current_test_info()->name();
};

const std::string text = "one\ntwo\r\n\n\rthree \\\nthree on\r\nfour\\\r\nfour on\rfive\\\rfive on\n\r\nlast";

TEST_F(TextBlocksTest, BlocksOfAnySize_AreTheTextCutBehindWholeLines) {
  const std::vector<std::string> lines{
      "one\n", "two\r\n", "\n", "\r", "three \\\nthree on\r\n", "four\\\r\nfour on\r", "five\\\rfive on\n",
      "\r\n",  "last"};
  std::vector<std::size_t> ends{0};
  for (const std::string& line : lines) ends.push_back(ends.back() + line.size());
  ASSERT_EQ(ends.back(), text.size());
  write(text);
  InputFile file(path);
  for (std::size_t size = 1; size < text.size() + 3; ++size) {
    SCOPED_TRACE(size);
    TextBlocks blocks(file, size);
    blocks.rewind();
    std::size_t end = 0;
    for (std::span<char> block; !(block = blocks.next()).empty();) {
      EXPECT_EQ(std::string(block.begin(), block.end()), text.substr(end, block.size()));
      end += block.size();
      EXPECT_NE(std::find(ends.begin(), ends.end(), end), ends.end()) << end;
      EXPECT_EQ(blocks.remaining(), text.size() - end);
    }
    EXPECT_EQ(end, text.size());
  }
}

TEST_F(TextBlocksTest, AfterRewind_TheTextBeginsAgain) {
  write(text);
  InputFile file(path);
  TextBlocks blocks(file, 24);
  const std::vector<std::string> first = blocks_of(blocks);
  EXPECT_GT(first.size(), 2u);
  blocks.rewind();
  EXPECT_EQ(blocks_of(blocks), first);
}

TEST_F(TextBlocksTest, AFileThatGrows_EndsWhereItDidWhenItWasOpened) {
  write(text);
  InputFile file(path);
  TextBlocks blocks(file, 24);
  const std::vector<std::string> first = blocks_of(blocks);
  write(text + "\nmore");
  blocks.rewind();
  EXPECT_EQ(blocks_of(blocks), first);
  EXPECT_EQ(blocks.remaining(), 0u);
  file.rewind();
  EXPECT_EQ(file.take(), text);
}

TEST_F(TextBlocksTest, AFileThatShrinks_IsRefused) {
  write(text);
  InputFile file(path);
  TextBlocks blocks(file, 24);
  blocks_of(blocks);
  write(text.substr(0, 20));
  blocks.rewind();
  try {
    blocks_of(blocks);
    FAIL();
  } catch (const IoError& error) {
    EXPECT_EQ(error.what(), path + ": byte 20: expected " + std::to_string(text.size()) +
                                " bytes as when it was opened, found the end of the file");
  }
  file.rewind();
  EXPECT_THROW(file.take(), IoError);
}

TEST_F(TextBlocksTest, APipe_CanBeReadTwiceToo) {
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  std::thread writer([this] { write(text); });
  InputFile file(path);
  writer.join();
  EXPECT_EQ(file.size(), text.size());
  TextBlocks blocks(file, 24);
  const std::vector<std::string> first = blocks_of(blocks);
  EXPECT_GT(first.size(), 2u);
  blocks.rewind();
  EXPECT_EQ(blocks_of(blocks), first);
}

}  // namespace
}  // namespace lambake
