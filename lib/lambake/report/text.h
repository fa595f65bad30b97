#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// Text of the page: internal to the folder.
namespace lambake {

/// For HTML and SVG, in text and in quoted attributes. Bytes that are no UTF-8, and control characters that
/// HTML forbids, become U+FFFD.
std::string escape_html(std::string_view text);

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

/// Whole numbers with a thin space between groups of three digits: 1 234 567.
std::string grouped(std::size_t number);

/// Three significant digits, or whole and grouped from 10,000: "0.0123", "12.3", "12 346"; with an exponent
/// below 0.001: "1.2e-05"; "∞" and "not a number" by name.
std::string short_number(double number);

/// A value on screen in steps of 1/255: "0.61/255".
std::string steps_of_255(double value);

/// An upper bound like short_number(), rounded up, so that it is one still.
std::string short_bound(double bound);

/// An upper bound on screen in steps of 1/255, rounded up.
std::string bound_of_255(double bound);

/// A share of 1 in percent: "12.3 %", "< 0.01 %" for what is above 0 and would round to it.
std::string percent(double share);

/// Seconds for people: "80 µs", "12.3 ms", "4.56 s".
std::string duration(double seconds);

}  // namespace lambake
