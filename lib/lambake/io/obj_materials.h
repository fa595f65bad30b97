#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lambake/io/canonical_file.h"
#include "lambake/io/file_texture.h"
#include "lambake/io/text_cursor.h"

namespace lambake {

/// The materials of the .mtl files that an OBJ names.
class ObjMaterials {
 public:
  /// @param path  of the OBJ file. @param file  gets materials, textures and findings.
  ObjMaterials(const std::string& path, CanonicalFile& file)
      : path_(path), file_(file), textures_(path, file) {}

  /// Reads the .mtl files of a mtllib line, each once; a missing one is a finding. @throws IoError if a
  /// number in one is none.
  /// @param names  the line behind its keyword: one name, in which there may be blanks, or several.
  void read_libraries(std::string_view names);
  /// The index of the material in the file's list; a name that is not known is a finding and white.
  std::uint32_t use(const std::string& name);
  /// Tells what was missing or is not shown, each kind in one finding.
  void finish();

 private:
  struct Entry {
    LinearRgb diffuse{1, 1, 1};         // As the file has it, as is the emission.
    std::optional<LinearRgb> emission;  // None: that of its texture, if there is one.
    std::string texture, emission_texture;
    bool is_transparent = false;
  };
  void read_library(const std::string& name);
  void read_line(TextCursor& cursor, std::string_view keyword, Entry& entry);
  std::optional<LinearRgb> read_color(TextCursor& cursor, const char* expected);
  std::uint32_t add(const std::string& name, const Entry& entry);
  LinearRgb emission_of(const Entry& entry);

  const std::string& path_;
  CanonicalFile& file_;
  FileTextures textures_;
  std::set<std::string> libraries_;  // That were read, or are missing.
  std::map<std::string, Entry> entries_;
  std::map<std::string, std::uint32_t> used_;
  std::vector<std::string> missing_files_, unknown_names_;
  std::size_t n_options_ = 0, n_unread_colors_ = 0, n_odd_emissions_ = 0;
};

}  // namespace lambake
