#pragma once

#include <string>

#include "lambake/report/comparison.h"

/// The pictures of the page: internal to the folder.
namespace lambake {

/// The sections that show the first view: its two pictures on top of each other, where and by how much they
/// differ, the worst pixels enlarged.
/// @throws IoError if a picture cannot be encoded.
std::string picture_sections(const Comparison& comparison);

}  // namespace lambake
