#include "lambake/io/temporary.h"

#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <string>
#include <system_error>
#include <vector>

namespace lambake {
namespace {

struct Registry {
  std::mutex mutex;
  std::vector<const Temporary*> entries;
};

/// Never destroyed: a thread that waits for signals may outlive static objects.
Registry& registry() {
  static auto& the_registry = *new Registry;
  return the_registry;
}

void remove(const Temporary& temporary) {
  std::error_code ignored;  // Nobody is left to be told; it may never have been made.
  std::filesystem::remove_all(temporary.path(), ignored);
}

}  // namespace

Temporary::Temporary(const std::filesystem::path& target)
    : path_(target.parent_path() /
            (".lambake-" + std::to_string(::getpid()) + "-" + target.filename().string())) {
  const std::lock_guard lock(registry().mutex);
  registry().entries.push_back(this);
}

Temporary::~Temporary() {
  const std::lock_guard lock(registry().mutex);
  remove(*this);
  auto& entries = registry().entries;
  entries.erase(std::find(entries.begin(), entries.end(), this));
}

void without_removal(const std::function<void()>& body) {
  const std::lock_guard lock(registry().mutex);
  body();
}

void remove_temporaries() {
  registry().mutex.lock();  // For good.
  for (const Temporary* temporary : registry().entries) remove(*temporary);
}

}  // namespace lambake
