#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace lambake {

/// The canonical form of a text file, line by line. As long as its lines are the file's own, with comments
/// (#) and empty lines between at most, nothing is copied: most files are so.
class CanonicalText {
 public:
  static constexpr std::size_t nowhere = std::string::npos;

  /// @param text  the whole file; has to stay as it is until take().
  explicit CanonicalText(std::string& text) : text_(text) {}

  /// Appends a line, its end included. @param at  where in the file the same line may stand, or `nowhere`.
  /// @returns where it begins.
  std::size_t append(std::string_view line, std::size_t at) {
    if (!is_copy_) {
      if (at != nowhere && is_gap(end_, at) && text_.compare(at, line.size(), line) == 0) {
        end_ = at + line.size();
        return at;
      }
      is_copy_ = true;
      copy_.reserve(text_.size() + text_.size() / 8);
      copy_.assign(text_, 0, end_);
    }
    copy_ += line;
    return copy_.size() - line.size();
  }

  /// The line that begins at `begin`, its end included; valid until the next call.
  std::string_view line_at(std::size_t begin) const {
    const std::string_view text = is_copy_ ? copy_ : text_;
    return text.substr(begin, text.find('\n', begin) + 1 - begin);
  }

  /// The text, of which the file's own is given away.
  std::string take() {
    if (is_copy_) return std::move(copy_);
    text_.resize(end_);
    return std::move(text_);
  }

 private:
  /// True if there are only whole comments and empty lines from `begin` to `end`.
  bool is_gap(std::size_t begin, std::size_t end) const {
    if (begin > end) return false;
    const std::string_view gap = std::string_view(text_).substr(begin, end - begin);
    for (std::size_t at = 0, next; at < gap.size(); at = next + 1) {
      next = gap.find('\n', at);
      const bool is_skipped = gap[at] == '#' || gap[at] == '\n';
      if (!is_skipped || next == std::string_view::npos) return false;
    }
    return gap.find('\r') == std::string_view::npos;
  }

  std::string& text_;
  std::size_t end_ = 0;  // Of what is taken of the file.
  std::string copy_;     // Instead, once a line differs.
  bool is_copy_ = false;
};

}  // namespace lambake
