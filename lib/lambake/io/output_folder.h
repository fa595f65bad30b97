#pragma once

#include <filesystem>
#include <string>

#include "lambake/io/temporary.h"

namespace lambake {

/// @throws IoError if `path` is there and no folder; InvalidOption if it is empty. To be asked before the
/// work.
void check_output_folder(const std::string& path);

/// Files that appear in a folder once all are written, or not at all: written into a folder beside it (or in
/// it, if it is there), moved by commit(), which looks for what is in the way before it moves the first.
/// Files that the folder held under other names stay. Without a commit what was written is removed.
class OutputFolder {
 public:
  /// @throws IoError if nothing can be made beside `path`, or `path` is there and no folder.
  explicit OutputFolder(const std::string& path);

  /// Where to write the file of this name until the commit.
  std::string file(const std::string& name) const { return (temporary_.path() / name).string(); }
  void commit();

 private:
  std::filesystem::path path_;
  Temporary temporary_;
};

}  // namespace lambake
