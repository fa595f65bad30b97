#pragma once

#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include "lambake/core/error.h"
#include "lambake/io/text_blocks.h"

namespace lambake {

/// The text without the three bytes that some programs put in front of UTF-8.
inline std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

/// A place in a text that is read token by token, strictly: whatever is not what was asked for throws IoError
/// with the line. Lines end with LF, CR LF or CR.
class TextCursor {
 public:
  /// @param comment  character that hides the rest of a line, or 0 for none.
  TextCursor(const std::string& path, std::string_view text, char comment, std::size_t first_line = 1)
      : path_(&path),
        at_(text.data()),
        end_(text.data() + text.size()),
        line_(first_line),
        comment_(comment) {}
  /// The text is a file's, block by block; skip_to_token() moves from one to the next.
  TextCursor(const std::string& path, TextBlocks& blocks, char comment) : TextCursor(path, "", comment) {
    blocks_ = &blocks;
    next_block();
  }

  const char* position() const { return at_; }
  std::size_t line() const { return line_; }
  /// Bytes of the text that are left.
  std::size_t remaining() const {
    return static_cast<std::size_t>(end_ - at_) + (blocks_ == nullptr ? 0 : blocks_->remaining());
  }

  /// True at the end of the line's tokens (a comment counts as the end).
  bool at_line_end() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    return at_ == end_ || is_newline(*at_) || (*at_ == comment_ && comment_ != 0);
  }
  /// Moves behind the end of this line.
  void next_line() {
    while (at_ != end_ && !is_newline(*at_)) ++at_;
    if (at_ == end_) return;
    const bool is_cr = *at_++ == '\r';
    if (is_cr && at_ != end_ && *at_ == '\n') ++at_;
    ++line_;
  }
  /// Counts lines that the text no longer shows.
  void add_lines(std::size_t n) { line_ += n; }
  /// Moves to the next token, over lines; false at the end of the text.
  bool skip_to_token() {
    while (at_line_end()) {
      if (at_ != end_)
        next_line();
      else if (!next_block())
        return false;
    }
    return true;
  }
  /// How many lines from here on have a token; moves to the end of the text.
  std::size_t count_lines() {
    std::size_t n = 0;
    for (; skip_to_token(); next_line()) ++n;
    return n;
  }
  /// The token here; empty at the end of the line.
  std::string_view token() {
    if (at_line_end()) return {};
    const char* const begin = at_;
    while (at_ != end_ && !is_separator(*at_)) ++at_;
    return {begin, static_cast<std::size_t>(at_ - begin)};
  }
  /// The rest of the line without blanks around it: a name, in which no character begins a comment.
  std::string_view rest_of_line() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    const char* const begin = at_;
    while (at_ != end_ && !is_newline(*at_)) ++at_;
    const char* last = at_;
    while (last != begin && is_blank(last[-1])) --last;
    return {begin, static_cast<std::size_t>(last - begin)};
  }

  /// A number on this line; nan and inf are numbers, and so is what overflows.
  float number(const char* expected) {
    if (at_line_end()) fail(expected, {});
    float value = 0;
    const char* begin = at_;
    if (*begin == '+' && begin + 1 != end_ && begin[1] != '-') ++begin;
    const auto [stop, error] = std::from_chars(begin, end_, value);
    if (error == std::errc::invalid_argument || (stop != end_ && !is_separator(*stop)))
      fail(expected, token());
    if (error == std::errc::result_out_of_range)
      value = std::strtof(std::string(begin, stop).c_str(), nullptr);
    at_ = stop;
    return value;
  }
  /// A whole number on this line that fits `Integer`.
  template <typename Integer>
  Integer integer(const char* expected) {
    if (at_line_end()) fail(expected, {});
    const char* const begin = at_;
    const Integer value = integer_prefix<Integer>(expected);
    if (at_ != end_ && !is_separator(*at_)) fail_at(begin, expected);
    return value;
  }
  /// The same, but anything may follow it.
  template <typename Integer>
  Integer integer_prefix(const char* expected) {
    Integer value{};
    const char* begin = at_;
    if (begin != end_ && *begin == '+' && begin + 1 != end_ && begin[1] != '-') ++begin;
    const auto [stop, error] = std::from_chars(begin, end_, value);
    if (error != std::errc()) fail(expected, token());
    at_ = stop;
    return value;
  }
  /// Takes `c` if it is the next character.
  bool accept(char c) {
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }
  bool at_separator() const { return at_ == end_ || is_separator(*at_); }

  /// Fails for the token that begins at `begin`, a position that the cursor has passed on this line.
  [[noreturn]] void fail_at(const char* begin, const std::string& expected) {
    at_ = begin;
    fail(expected, token());
  }
  [[noreturn]] void fail(const std::string& expected, std::string_view found) const {
    throw IoError(*path_, "line " + std::to_string(line_) + ": expected " + expected + ", found " +
                              (found.empty() ? describe_end() : quote(found)));
  }

 private:
  static bool is_newline(char c) { return c == '\n' || c == '\r'; }
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  bool is_separator(char c) const { return is_blank(c) || is_newline(c) || (c == comment_ && c != '\0'); }
  bool next_block() {
    if (blocks_ == nullptr) return false;
    const std::span<const char> block = blocks_->next();
    at_ = block.data();
    end_ = at_ + block.size();
    return !block.empty();
  }
  std::string describe_end() const { return at_ == end_ ? "the end of the file" : "the end of the line"; }
  /// Printable and short, whatever the file holds.
  static std::string quote(std::string_view found) {
    std::string text = "\"";
    for (const char c : found.substr(0, 40)) text += c >= ' ' && c < '\x7f' ? c : '?';
    return text + (found.size() > 40 ? "…\"" : "\"");
  }

  const std::string* path_;
  TextBlocks* blocks_ = nullptr;
  const char* at_;
  const char* end_;
  std::size_t line_;
  char comment_;
};

}  // namespace lambake
