#include "lambake/io/output_folder.h"

#include <unistd.h>

#include <system_error>

#include "lambake/core/error.h"

namespace lambake {

void check_output_folder(const std::string& path) {
  if (path.empty()) throw InvalidOption("-o: expected a folder, found nothing");
  if (std::filesystem::exists(path) && !std::filesystem::is_directory(path))
    throw IoError(path, "expected a folder, found a file");
}

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  check_output_folder(path);
  std::filesystem::path target = path_.lexically_normal();
  if (!target.has_filename()) target = target.parent_path();  // "out/" names the folder "out".
  if (target.empty() || target == "." || target == "..")
    target = std::filesystem::absolute(path_).lexically_normal();
  path_ = target;
  std::error_code error;
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), error);
  if (error) throw IoError(path, "cannot be made: " + error.message());
  temporary_ =
      path_.parent_path() / (".lambake-" + std::to_string(::getpid()) + "-" + path_.filename().string());
  std::filesystem::create_directory(temporary_, error);
  if (error) throw IoError(path, "cannot be made: " + error.message());
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;  // Nothing can be told from a destructor.
  std::filesystem::remove_all(temporary_, ignored);
}

void OutputFolder::commit() {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  for (auto it = std::filesystem::directory_iterator(temporary_, error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error)) {
    std::error_code move_error;
    std::filesystem::rename(it->path(), path_ / it->path().filename(), move_error);
    if (move_error)
      throw IoError((path_ / it->path().filename()).string(), "cannot be written: " + move_error.message());
  }
  if (error) throw IoError(path_.string(), "cannot be written: " + error.message());
}

}  // namespace lambake
