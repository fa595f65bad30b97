#pragma once

#include <charconv>

namespace lambake {

/// Reads what C libraries of Microsoft print for numbers that are not finite (up to those of 2013): "1.#INF",
/// "-1.#IND", "1.#QNAN" or "1.#SNAN", its zeros and exponent too if the format asked for them
/// ("-1.#IND00e+000"). Where it asked for few digits the name is rounded like these ("1.#QO", "1.#J") and may
/// stand for either; that is read as NaN.
/// @param begin  of the text, up to `end`.
/// @param value  is set to NaN, or to an infinity.
/// @returns as std::from_chars(): behind the text, or `begin` and an error if it is none of that.
std::from_chars_result microsoft_from_chars(const char* begin, const char* end, float& value);

}  // namespace lambake
