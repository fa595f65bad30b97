#include "lambake/io/gltf/compression.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <cstring>
#include <map>
#include <memory>
#include <utility>

#include "lambake/core/error.h"
#include "lambake/io/json_text.h"

namespace lambake {
namespace {

/// The most that all of a file decompresses to: streams may be named many times.
constexpr std::uint64_t free_bytes = std::uint64_t{1} << 28, bytes_per_byte = 256;

/// The most that a byte of a meshopt stream can stand for: 2 header bits are a group of 16 bytes.
constexpr std::uint64_t largest_meshopt_ratio = 64;

class Decompressor {
 public:
  Decompressor(const GltfSource& source, GltfJson& plain, std::vector<std::vector<unsigned char>>& buffers)
      : source_(source), plain_(plain), buffers_(buffers), n_file_buffers_(buffers.size()) {
    std::uint64_t n_file_bytes = 0;
    for (const std::vector<unsigned char>& bytes : buffers) n_file_bytes += bytes.size();
    n_bytes_left_ = free_bytes + bytes_per_byte * n_file_bytes;
  }

  void run() {
    const std::size_t n_views = member(plain_, "bufferViews").size();
    std::vector<std::pair<std::size_t, const GltfJson*>> views;
    for (std::size_t i = 0; i < n_views; ++i) {
      const GltfJson& extension = member(member(source_.json["bufferViews"][i], "extensions"), gltf::meshopt);
      if (extension.is_object()) views.emplace_back(i, &extension);
    }
    const std::vector<bool> is_used = views.empty() ? std::vector<bool>() : used_views();
    for (const auto& [i, extension] : views) {
      where_ = fmt::format("bufferViews[{}].extensions.{}", i, gltf::meshopt);
      if (is_used[i])
        decode_view(i, *extension);
      else
        leave_out_view(i, *extension);
    }
    const std::size_t n_meshes = member(plain_, "meshes").size();
    for (std::size_t m = 0; m < n_meshes; ++m) {
      if (!plain_["meshes"][m].is_object()) continue;
      const std::size_t n_primitives = member(plain_["meshes"][m], "primitives").size();
      for (std::size_t p = 0; p < n_primitives; ++p) {
        GltfJson& primitive = plain_["meshes"][m]["primitives"][p];
        const GltfJson extension = member(member(primitive, "extensions"), gltf::draco);
        if (!extension.is_object()) continue;
        where_ = fmt::format("meshes[{}].primitives[{}]", m, p);
        decode_draco(primitive, extension);
      }
    }
  }

 private:
  [[noreturn]] void fail(const std::string& text) const { throw IoError(source_.path, where_ + ": " + text); }

  /// The bytes [offset, offset + length) of a buffer of the file.
  std::span<const unsigned char> bytes_of(const GltfJson& json) const {
    const std::uint64_t buffer = whole_or(json, "buffer", 0), offset = whole_or(json, "byteOffset", 0),
                        length = whole_or(json, "byteLength", 0);
    if (buffer >= n_file_buffers_)
      fail(fmt::format("expected a buffer below {}, found {}", n_file_buffers_, buffer));
    const std::vector<unsigned char>& bytes = buffers_[buffer];
    if (offset > bytes.size() || length > bytes.size() - offset)
      fail(fmt::format("expected bytes within a buffer of {}, found {} from {}", bytes.size(), length,
                       offset));
    return {bytes.data() + offset, length};
  }

  /// Which views have accessors or images.
  std::vector<bool> used_views() const {
    std::vector<bool> is_used(member(source_.json, "bufferViews").size(), false);
    const auto use = [&](const GltfJson& holder) {
      const std::uint64_t view = whole_or(holder, "bufferView", is_used.size());
      if (view < is_used.size()) is_used[view] = true;
    };
    for (const GltfJson& accessor : member(source_.json, "accessors")) {
      use(accessor);
      for (const char* part : {"indices", "values"}) use(member(member(accessor, "sparse"), part));
    }
    for (const GltfJson& image : member(source_.json, "images")) use(image);
    return is_used;
  }

  /// A view that nothing reads is not decoded; some bytes stand in for it.
  void leave_out_view(std::size_t index, const GltfJson& extension) {
    static_cast<void>(bytes_of(extension));  // Checked all the same.
    GltfJson& view = plain_["bufferViews"][index];
    view["buffer"] = whole_or(extension, "buffer", 0);
    view["byteOffset"] = 0;
    view["byteLength"] = 1;
    view.erase("extensions");
  }

  void decode_view(std::size_t index, const GltfJson& extension) {
    const std::span<const unsigned char> packed = bytes_of(extension);
    const std::uint64_t count = whole_or(extension, "count", 0),
                        stride = whole_or(extension, "byteStride", 0);
    const std::string mode = text(extension, "mode", ""), filter = text(extension, "filter", "NONE");
    if (stride == 0 || stride > 256) fail(fmt::format("expected a byteStride of 1 to 256, found {}", stride));
    if (count == 0 || count > packed.size() * largest_meshopt_ratio / stride + 64)
      fail(fmt::format("expected a count that {} bytes can hold, found {}", packed.size(), count));
    std::vector<unsigned char> bytes(count * stride);
    int error = -1;
    if (mode == "ATTRIBUTES" && stride % 4 == 0)
      error = meshopt_decodeVertexBuffer(bytes.data(), count, stride, packed.data(), packed.size());
    else if (mode == "TRIANGLES" && count % 3 == 0 && (stride == 2 || stride == 4))
      error = meshopt_decodeIndexBuffer(bytes.data(), count, stride, packed.data(), packed.size());
    else if (mode == "INDICES" && (stride == 2 || stride == 4))
      error = meshopt_decodeIndexSequence(bytes.data(), count, stride, packed.data(), packed.size());
    if (error != 0) fail(fmt::format("the {} stream does not decode", mode));
    if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
      meshopt_decodeFilterOct(bytes.data(), count, stride);
    else if (filter == "QUATERNION" && stride == 8)
      meshopt_decodeFilterQuat(bytes.data(), count, stride);
    else if (filter == "EXPONENTIAL" && stride % 4 == 0)
      meshopt_decodeFilterExp(bytes.data(), count, stride);
    else if (filter != "NONE")
      fail(fmt::format("the filter {} is not known for a byteStride of {}", filter, stride));
    GltfJson& view = plain_["bufferViews"][index];
    view["byteLength"] = bytes.size();
    view["byteOffset"] = 0;
    view["buffer"] = add_buffer(std::move(bytes));
    view.erase("extensions");
  }

  static std::string text(const GltfJson& json, const char* key, const char* fallback) {
    const GltfJson& value = member(json, key);
    return value.is_null() ? fallback : value.get<std::string>();
  }

  std::size_t add_buffer(std::vector<unsigned char> bytes) {
    if (bytes.size() > n_bytes_left_)
      fail(
          fmt::format("expected a file that decompresses to at most {} bytes and {} for each of its own, "
                      "found more",
                      free_bytes, bytes_per_byte));
    n_bytes_left_ -= bytes.size();
    plain_["buffers"].push_back({{"byteLength", bytes.size()}});
    buffers_.push_back(std::move(bytes));
    return buffers_.size() - 1;
  }

  void decode_draco(GltfJson& primitive, const GltfJson& extension) {
    const std::uint64_t view = whole_or(extension, "bufferView", 0);
    if (view >= member(source_.json, "bufferViews").size())
      fail(fmt::format("expected a buffer view that there is, found {}", view));
    const std::span<const unsigned char> packed = bytes_of(source_.json["bufferViews"][view]);
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
    std::unique_ptr<draco::Mesh> mesh;
    try {
      auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
      if (!decoded.ok()) fail("the Draco stream does not decode: " + decoded.status().error_msg_string());
      mesh = std::move(decoded).value();
    } catch (const std::bad_alloc&) {
      fail("the Draco stream asks for more memory than there is");
    }
    const GltfJson& indices = member(primitive, "indices");
    if (!indices.is_null()) {
      std::vector<std::uint32_t> values;
      values.reserve(3 * std::size_t{mesh->num_faces()});
      for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f)
        for (const draco::PointIndex& point : mesh->face(f)) values.push_back(point.value());
      GltfJson& accessor = accessor_at(indices);
      accessor["componentType"] = gltf::unsigned_int;
      fill(accessor, values, values.size());
    }
    for (const auto& [semantic, id] : member(extension, "attributes").items()) {
      const GltfJson& index = member(member(primitive, "attributes"), semantic.c_str());
      const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(id.get<std::uint32_t>());
      if (index.is_null() || attribute == nullptr) fail("the Draco stream has no attribute for " + semantic);
      decode_attribute(*mesh, *attribute, accessor_at(index));
    }
  }

  GltfJson& accessor_at(const GltfJson& index) {
    if (index.get<std::size_t>() >= member(plain_, "accessors").size())
      fail("expected an accessor that there is, found " + shown(index));
    return plain_["accessors"][index.get<std::size_t>()];
  }

  void decode_attribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute, GltfJson& accessor) {
    switch (whole_or(accessor, "componentType", 0)) {
      case gltf::byte:
        return convert<std::int8_t>(mesh, attribute, accessor);
      case gltf::unsigned_byte:
        return convert<std::uint8_t>(mesh, attribute, accessor);
      case gltf::short_:
        return convert<std::int16_t>(mesh, attribute, accessor);
      case gltf::unsigned_short:
        return convert<std::uint16_t>(mesh, attribute, accessor);
      case gltf::unsigned_int:
        return convert<std::uint32_t>(mesh, attribute, accessor);
      case gltf::float_:
        return convert<float>(mesh, attribute, accessor);
      default:
        fail("expected a componentType of glTF, found " + shown(member(accessor, "componentType")));
    }
  }

  /// Values of all points as the accessor's component type; elements padded to 4 bytes, as attributes must
  /// be.
  template <typename T>
  void convert(const draco::Mesh& mesh, const draco::PointAttribute& attribute, GltfJson& accessor) {
    static const std::map<std::string, std::int8_t> n_components_of{
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
    const auto found = n_components_of.find(text(accessor, "type", ""));
    if (found == n_components_of.end() || found->second != attribute.num_components())
      fail(fmt::format("expected {} components, as the Draco stream has", attribute.num_components()));
    const std::int8_t n_components = found->second;
    std::vector<T> values(std::size_t{mesh.num_points()} * static_cast<std::size_t>(n_components));
    for (draco::PointIndex point(0); point < mesh.num_points(); ++point)
      if (!attribute.ConvertValue<T>(
              attribute.mapped_index(point), n_components,
              values.data() + std::size_t{point.value()} * static_cast<std::size_t>(n_components)))
        fail("the Draco stream has values that the accessor's type cannot hold");
    fill(accessor, values, mesh.num_points());
  }

  template <typename T>
  void fill(GltfJson& accessor, const std::vector<T>& values, std::uint64_t count) {
    if (whole_or(accessor, "count", 0) != count)
      fail(fmt::format("expected the accessor's count {}, found {} in the Draco stream",
                       whole_or(accessor, "count", 0), count));
    std::vector<unsigned char> bytes(values.size() * sizeof(T));
    if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    const std::size_t n_bytes = bytes.size();
    accessor["byteOffset"] = 0;
    accessor["bufferView"] =
        append_to(plain_, "bufferViews", {{"buffer", add_buffer(std::move(bytes))}, {"byteLength", n_bytes}});
  }

  const GltfSource& source_;
  GltfJson& plain_;
  std::vector<std::vector<unsigned char>>& buffers_;
  const std::size_t n_file_buffers_;
  std::uint64_t n_bytes_left_ = 0;
  std::string where_;
};

}  // namespace

void decompress(const GltfSource& source, GltfJson& plain, std::vector<std::vector<unsigned char>>& buffers) {
  Decompressor(source, plain, buffers).run();
}

}  // namespace lambake
