#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/io/canonical_file.h"
#include "lambake/io/text_cursor.h"

namespace lambake {
namespace {

constexpr std::size_t binary_header_size = 84, facet_size = 50;

/// Gathers facets as a binary STL, but for those that OpenMesh's reader drops or welds wrongly.
class FacetSink {
 public:
  explicit FacetSink(CanonicalFile& file) : file_(file) { file_.bytes.assign(binary_header_size, '\0'); }

  void add(const std::array<glm::vec3, 3>& corners) {
    const auto index = static_cast<std::uint32_t>(file_.n_faces++);
    if (!is_sound(corners)) {
      file_.loose_facets.push_back({index, corners});
      return;
    }
    char facet[facet_size] = {};
    std::memcpy(facet + 12, corners.data(), 36);
    file_.bytes.append(facet, facet_size);
  }
  void finish() {
    const auto n = static_cast<std::uint32_t>((file_.bytes.size() - binary_header_size) / facet_size);
    std::memcpy(file_.bytes.data() + 80, &n, 4);
  }

 private:
  static bool is_sound(const std::array<glm::vec3, 3>& corners) {
    for (const glm::vec3& p : corners) {
      if (!is_finite(p)) return false;
      // The reader takes what is closer than the smallest normal float for equal.
      for (int c = 0; c < 3; ++c)
        if (p[c] != 0 && std::abs(p[c]) < 1e-30f) return false;
    }
    return corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
  }
  CanonicalFile& file_;
};

void scan_binary(const std::string& path, std::string_view text, CanonicalFile& file) {
  std::uint32_t n = 0;
  std::memcpy(&n, text.data() + 80, 4);
  const std::size_t n_held = (text.size() - binary_header_size) / facet_size;
  if (n > n_held)
    throw IoError(path, fmt::format("byte 80: expected a count of at most {} triangles, as many as {} bytes "
                                    "hold, found {}",
                                    n_held, text.size(), n));
  if (n == 0) throw IoError(path, "byte 80: expected triangles, found 0");
  file.bytes.reserve(binary_header_size + n * facet_size);
  FacetSink sink(file);
  std::size_t n_words = 0;
  for (std::size_t f = 0; f < n; ++f) {
    const char* const facet = text.data() + binary_header_size + f * facet_size;
    std::array<glm::vec3, 3> corners;
    std::memcpy(corners.data(), facet + 12, 36);
    n_words += facet[48] != 0 || facet[49] != 0;
    sink.add(corners);
  }
  sink.finish();
  add_finding(file.findings, "attribute_words", n_words, "facet[ has|s have] an attribute word; not read");
  add_finding(file.findings, "trailing_bytes", text.size() - binary_header_size - n * facet_size,
              "byte[ follows|s follow] the last facet; not read");
}

bool is_keyword(std::string_view token, std::string_view keyword) {
  return token.size() == keyword.size() &&
         std::equal(token.begin(), token.end(), keyword.begin(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

class AsciiStlScan {
 public:
  AsciiStlScan(const std::string& path, std::string_view text, CanonicalFile& file)
      : cursor_(path, text, 0), file_(file), sink_(file) {}

  void run() {
    while (cursor_.skip_to_token()) {
      expect("solid");
      cursor_.next_line();
      scan_facets();
    }
    if (file_.n_faces == 0) cursor_.fail("\"facet\"", {});
    sink_.finish();
  }

 private:
  void expect(std::string_view keyword) {
    cursor_.skip_to_token();
    const std::string_view token = cursor_.token();
    if (!is_keyword(token, keyword)) cursor_.fail("\"" + std::string(keyword) + "\"", token);
  }
  void scan_facets() {
    for (;;) {
      if (!cursor_.skip_to_token()) cursor_.fail("\"facet\" or \"endsolid\"", {});
      const std::string_view keyword = cursor_.token();
      if (is_keyword(keyword, "endsolid")) {
        cursor_.next_line();
        return;
      }
      if (!is_keyword(keyword, "facet")) cursor_.fail("\"facet\" or \"endsolid\"", keyword);
      expect("normal");
      scan_vector();  // The facet's normal follows from its corners.
      expect("outer");
      expect("loop");
      std::array<glm::vec3, 3> corners;
      for (glm::vec3& corner : corners) {
        expect("vertex");
        corner = scan_vector();
      }
      expect("endloop");
      expect("endfacet");
      sink_.add(corners);
    }
  }
  glm::vec3 scan_vector() {
    glm::vec3 v;
    for (int c = 0; c < 3; ++c) v[c] = cursor_.number("three numbers");
    return v;
  }

  TextCursor cursor_;
  CanonicalFile& file_;
  FacetSink sink_;
};

/// By the size, as the header of a binary file may begin with "solid" too.
bool is_binary_stl(std::string_view text) {
  if (text.size() >= binary_header_size) {
    std::uint32_t n = 0;
    std::memcpy(&n, text.data() + 80, 4);
    if (binary_header_size + std::size_t{n} * facet_size == text.size()) return true;
  }
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  return begin == std::string_view::npos || !is_keyword(text.substr(begin, 5), "solid");
}

}  // namespace

CanonicalFile scan_stl(const std::string& path, std::string&& text) {
  CanonicalFile file;
  file.extension = "stl";
  if (!is_binary_stl(text)) {
    file.format = "STL ascii";
    AsciiStlScan(path, text, file).run();
    return file;
  }
  if (text.size() < binary_header_size)
    throw IoError(path, fmt::format("expected \"solid\" or the 84 bytes of a binary header, found {} bytes",
                                    text.size()));
  file.format = "STL binary";
  scan_binary(path, text, file);
  return file;
}

}  // namespace lambake
