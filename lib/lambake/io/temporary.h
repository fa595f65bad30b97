#pragma once

#include <filesystem>
#include <functional>

namespace lambake {

/// The place of a file or folder on its way to `target`: beside it, so that moving it there is one step. What
/// is there at the end of the scope is removed.
class Temporary {
 public:
  explicit Temporary(const std::filesystem::path& target);
  ~Temporary();
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Calls `body` so that remove_temporaries() comes before it or after.
void without_removal(const std::function<void()>& body);

/// Removes what is at the place of every Temporary, for a program that is about to be ended by a signal: from
/// then on none begins or ends. From any thread, but not from a signal handler.
void remove_temporaries();

}  // namespace lambake
