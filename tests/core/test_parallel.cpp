#include "lambake/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

namespace lambake {
namespace {

using Block = std::pair<std::size_t, std::size_t>;

/// The blocks of a loop, by where they begin, whatever the order they ran in.
std::vector<Block> blocks_of(std::size_t n, std::size_t block) {
  std::vector<Block> by_begin(n / block + 1, {0, 0});
  parallel_blocks(n, block, [&](std::size_t begin, std::size_t end) {
    by_begin[begin / block] = {begin, end};
  });
  return by_begin;
}

class ParallelBlocks : public testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override { set_thread_count(GetParam()); }
  void TearDown() override { set_thread_count(0); }
};

TEST_P(ParallelBlocks, EachIndexIsVisitedOnce) {
  for (const std::size_t n : {0, 1, 7, 8, 9, 10'000}) {
    std::vector<std::atomic<int>> visits(n);
    parallel_blocks(n, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    for (const std::atomic<int>& count : visits) EXPECT_EQ(count, 1);
  }
}

TEST_P(ParallelBlocks, BlocksAreTheSameForAnyNumberOfThreads_SoAreTheirSums) {
  EXPECT_EQ(blocks_of(20, 8), (std::vector<Block>{{0, 8}, {8, 16}, {16, 20}}));
  const auto harmonic = [] {
    std::vector<double> sums(101);
    parallel_blocks(100'001, 1000, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) sums[begin / 1000] += 1 / (1 + double(i));
    });
    double total = 0;
    for (const double sum : sums) total += sum;
    return total;
  };
  const double here = harmonic();
  set_thread_count(1);
  EXPECT_EQ(here, harmonic());
}

TEST_P(ParallelBlocks, AnExceptionOfTheBody_ReachesTheCaller) {
  EXPECT_THROW(parallel_blocks(1000, 10,
                               [](std::size_t begin, std::size_t) {
                                 if (begin == 500) throw std::runtime_error("halfway");
                               }),
               std::runtime_error);
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelBlocks, testing::Values(1, 2, 0));

TEST(ThreadCount, IsWhatWasAsked_AndAtLeastOne) {
  set_thread_count(1);
  EXPECT_EQ(thread_count(), 1U);
  set_thread_count(0);
  EXPECT_GE(thread_count(), 1U);
}

}  // namespace
}  // namespace lambake
