#include "lambake/io/output_folder.h"

#include <system_error>
#include <vector>

#include "lambake/core/error.h"
#include "lambake/io/output_file.h"

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

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  check_output_folder(path);
  std::filesystem::path target = path_.lexically_normal();
  if (!target.has_filename()) target = target.parent_path();  // "out/" names the folder "out".
  std::error_code error;
  if (target.empty() || target == "." || target == "..")
    target = std::filesystem::absolute(path_, error).lexically_normal();
  path_ = target;
  if (!error && path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), error);
  if (error) throw IoError(path, "cannot be made: " + error.message());
  temporary_ = temporary_beside(path_);
  std::filesystem::remove_all(temporary_, error);  // Left by a run that was stopped.
  if (!error) std::filesystem::create_directory(temporary_, error);
  if (error) throw IoError(path, "cannot be made: " + error.message());
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;  // Nothing can be told from a destructor.
  std::filesystem::remove_all(temporary_, ignored);
}

void OutputFolder::commit() {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  std::vector<std::filesystem::path> names;
  for (auto it = std::filesystem::directory_iterator(temporary_, error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error))
    names.push_back(it->path().filename());
  if (error) throw IoError(path_.string(), "cannot be written: " + error.message());
  for (const std::filesystem::path& name : names)
    if (std::filesystem::is_directory(path_ / name, error))
      throw IoError((path_ / name).string(), "expected a file to replace, found a folder");
  for (const std::filesystem::path& name : names) {
    std::filesystem::rename(temporary_ / name, path_ / name, error);
    if (error) throw IoError((path_ / name).string(), "cannot be written: " + error.message());
  }
}

}  // namespace lambake
