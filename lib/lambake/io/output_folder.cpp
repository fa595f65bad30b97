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

namespace {

/// As the system finds it, with links followed.
std::filesystem::path resolved_folder(const std::string& path) {
  check_output_folder(path);
  std::error_code error;
  std::filesystem::path folder = std::filesystem::weakly_canonical(path, error);
  if (error) throw IoError(path, "cannot be made: " + error.message());
  return folder.has_filename() ? folder : folder.parent_path();
}

/// Beside a folder that is to come, so that there is none if it fails; inside of one that is there, as what
/// is beside it may be another file system, or closed.
std::filesystem::path place_of_temporary(const std::filesystem::path& folder) {
  return std::filesystem::is_directory(folder) ? folder / "files" : folder;
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path)
    : path_(resolved_folder(path)), temporary_(place_of_temporary(path_)) {
  std::error_code error;
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), error);
  if (!error) std::filesystem::remove_all(temporary_.path(), error);  // Left by a run that was killed.
  if (!error) std::filesystem::create_directory(temporary_.path(), error);
  if (error) {
    const bool is_there = std::filesystem::is_directory(path_);
    throw IoError(path, (is_there ? "cannot be written into: " : "cannot be made: ") + error.message());
  }
}

void OutputFolder::commit() {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  std::vector<std::filesystem::path> from, to;
  for (auto it = std::filesystem::directory_iterator(temporary_.path(), error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error))
    from.push_back(it->path());
  if (error) throw IoError(path_.string(), "cannot be written: " + error.message());
  for (const std::filesystem::path& file : from)
    to.emplace_back(target_of((path_ / file.filename()).string()));
  without_removal([&] {
    for (std::size_t i = 0; i < from.size(); ++i) {
      std::filesystem::rename(from[i], to[i], error);
      if (error) throw IoError(to[i].string(), "cannot be written: " + error.message());
    }
  });
}

}  // namespace lambake
