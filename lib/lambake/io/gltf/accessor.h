#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// Accessors as plain arrays: stride, normalisation and sparse parts resolved; internal to io.
namespace lambake {

/// Throws IoError unless every view lies in its buffer and every accessor, its sparse part included, in its
/// views, with a component type and a type of glTF.
void check_accessors(const std::string& path, const tinygltf::Model& model);

/// Components of an accessor's type: 1 for SCALAR to 16 for MAT4.
std::size_t n_components_of(const tinygltf::Accessor& accessor);

/// Bytes of a component; 0 where the type is none of glTF's.
std::size_t component_bytes(int component_type);

/// A component. Normalised integers by the specification: c / max, and for signed ones max(c / max, -1).
float load_float(const unsigned char* bytes, int component_type, bool is_normalized);

/// count × n_components values; integers as they are, or in [-1,1] where the accessor is normalised.
std::vector<float> decode_floats(const tinygltf::Model& model, std::size_t accessor);

/// The same of some elements alone, in the time that these take.
/// @param elements  n numbers below the accessor's count.
std::vector<float> decode_floats(const tinygltf::Model& model, std::size_t accessor,
                                 std::span<const std::uint32_t> elements);

/// `count` whole numbers of an accessor of unsigned integers.
std::vector<std::uint32_t> decode_unsigned(const tinygltf::Model& model, std::size_t accessor);

/// The elements' bytes, without gaps but those in matrices, whose columns take multiples of 4 bytes.
std::vector<unsigned char> decode_bytes(const tinygltf::Model& model, std::size_t accessor);
std::vector<unsigned char> decode_bytes(const tinygltf::Model& model, std::size_t accessor,
                                        std::span<const std::uint32_t> elements);

}  // namespace lambake
