#pragma once

#include <map>
#include <string>
#include <vector>

#include "lambake/io/canonical_file.h"

namespace lambake {

/// The materials of the .mtl files that an OBJ names.
class ObjMaterials {
 public:
  /// @param path  of the OBJ file. @param file  gets materials, textures and findings.
  ObjMaterials(const std::string& path, CanonicalFile& file) : path_(path), file_(file) {}

  /// Reads a .mtl file; a missing one is a finding. @throws IoError if a number in it is none.
  void read_library(const std::string& name);
  /// The index of the material in the file's list; a name that is not known is a finding and white.
  std::uint32_t use(const std::string& name);
  /// Tells what was missing, each kind in one finding.
  void finish();

 private:
  struct Entry {
    LinearRgb diffuse{1, 1, 1};
    std::string texture;
  };
  std::uint32_t add(const std::string& name, const Entry& entry);

  const std::string& path_;
  CanonicalFile& file_;
  std::map<std::string, Entry> entries_;
  std::map<std::string, std::uint32_t> used_;
  std::map<std::string, std::uint32_t> texture_indices_;
  std::vector<std::string> missing_files_, unknown_names_;
};

}  // namespace lambake
