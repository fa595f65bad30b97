#include "lambake/io/output_folder.h"

#include <system_error>
#include <vector>

#include "lambake/core/error.h"

namespace lambake {

void check_output_folder(const std::string& path) {
  if (path.empty()) throw InvalidOption("-o: expected a folder, found nothing");
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status)) {
    if (!std::filesystem::is_directory(status)) throw IoError(path, "expected a folder, found a file");
  } else if (error && status.type() != std::filesystem::file_type::not_found) {
    throw IoError(path, "cannot be made: " + error.message());
  }
}

namespace {

/// With a name at its end, which "out/" and "." have not.
std::filesystem::path named_folder(const std::string& path) {
  check_output_folder(path);
  std::filesystem::path target = std::filesystem::path(path).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  if (!target.empty() && target != "." && target != "..") return target;
  std::error_code error;
  target = std::filesystem::absolute(path, error).lexically_normal();
  if (error) throw IoError(path, "cannot be made: " + error.message());
  return target;
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path) : path_(named_folder(path)), temporary_(path_) {
  std::error_code error;
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), error);
  if (!error) std::filesystem::remove_all(temporary_.path(), error);  // Left by a run that was killed.
  if (!error) std::filesystem::create_directory(temporary_.path(), error);
  if (error) throw IoError(path, "cannot be made: " + error.message());
}

void OutputFolder::commit() {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  std::vector<std::filesystem::path> names;
  for (auto it = std::filesystem::directory_iterator(temporary_.path(), error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error))
    names.push_back(it->path().filename());
  if (error) throw IoError(path_.string(), "cannot be written: " + error.message());
  for (const std::filesystem::path& name : names)
    if (std::filesystem::is_directory(path_ / name, error))
      throw IoError((path_ / name).string(), "expected a file to replace, found a folder");
  for (const std::filesystem::path& name : names) {
    std::filesystem::rename(temporary_.path() / name, path_ / name, error);
    if (error) throw IoError((path_ / name).string(), "cannot be written: " + error.message());
  }
}

}  // namespace lambake
