#include "lambake/io/gltf/accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <ranges>

#include "lambake/core/error.h"
#include "lambake/io/gltf/document.h"

namespace lambake {
namespace {

/// Where the components of an element lie. Columns of matrices begin at multiples of 4 bytes (glTF 2.0,
/// 3.6.2.4); all else is one column.
struct ElementLayout {
  explicit ElementLayout(const tinygltf::Accessor& accessor)
      : n_component_bytes(component_bytes(accessor.componentType)) {
    const std::size_t n = n_components_of(accessor);
    const bool is_matrix = accessor.type == TINYGLTF_TYPE_MAT2 || accessor.type == TINYGLTF_TYPE_MAT3 ||
                           accessor.type == TINYGLTF_TYPE_MAT4;
    if (is_matrix) n_columns = n == 4 ? 2 : n == 9 ? 3 : 4;
    n_rows = n / n_columns;
    column_stride = n_rows * n_component_bytes;
    if (is_matrix) column_stride = (column_stride + 3) / 4 * 4;
  }

  std::size_t size() const { return (n_columns - 1) * column_stride + n_rows * n_component_bytes; }
  std::size_t stride() const { return n_columns * column_stride; }  ///< Of elements without gaps.

  std::size_t n_component_bytes = 0, n_columns = 1, n_rows = 1, column_stride = 0;
};

const unsigned char* view_begin(const tinygltf::Model& model, int view_index) {
  const tinygltf::BufferView& view = model.bufferViews[index_of(view_index)];
  return model.buffers[index_of(view.buffer)].data.data() + view.byteOffset;
}

template <typename T>
T load(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

std::uint32_t load_unsigned(const unsigned char* bytes, int component_type) {
  switch (component_type) {
    case gltf::unsigned_byte:
      return load<std::uint8_t>(bytes);
    case gltf::unsigned_short:
      return load<std::uint16_t>(bytes);
    default:
      return load<std::uint32_t>(bytes);
  }
}

class AccessorCheck {
 public:
  AccessorCheck(const std::string& path, const tinygltf::Model& model) : path_(path), model_(model) {}

  void run() {
    for (std::size_t i = 0; i < model_.bufferViews.size(); ++i) {
      where_ = fmt::format("bufferViews[{}]", i);
      const tinygltf::BufferView& view = model_.bufferViews[i];
      expect(view.buffer >= 0 && index_of(view.buffer) < model_.buffers.size(), "a buffer that there is",
             view.buffer);
      const std::size_t n_bytes = model_.buffers[index_of(view.buffer)].data.size();
      expect(fits(view.byteOffset, view.byteLength, n_bytes),
             fmt::format("bytes within the buffer of {}", n_bytes),
             fmt::format("{} from {}", view.byteLength, view.byteOffset));
    }
    for (const tinygltf::Buffer& buffer : model_.buffers) n_file_bytes_ += buffer.data.size();
    for (std::size_t i = 0; i < model_.accessors.size(); ++i) {
      where_ = fmt::format("accessors[{}]", i);
      check(model_.accessors[i]);
    }
  }

 private:
  template <typename Found>
  void expect(bool holds, const std::string& expected, const Found& found) const {
    if (!holds) throw IoError(path_, fmt::format("{}: expected {}, found {}", where_, expected, found));
  }

  static bool fits(std::size_t offset, std::size_t length, std::size_t size) {
    return offset <= size && length <= size - offset;
  }

  /// Whether `count` elements, `stride` apart, lie in a view from `offset` on.
  void check_elements(int view_index, std::size_t offset, std::size_t count, std::size_t stride,
                      std::size_t element_bytes) const {
    expect(view_index >= 0 && index_of(view_index) < model_.bufferViews.size(), "a buffer view that there is",
           view_index);
    const std::size_t size = model_.bufferViews[index_of(view_index)].byteLength;
    const bool is_inside = offset <= size && element_bytes <= size - offset &&
                           count - 1 <= (size - offset - element_bytes) / stride;
    expect(is_inside, fmt::format("elements within the view of {} bytes", size),
           fmt::format("{} elements of {} bytes, {} apart, from {}", count, element_bytes, stride, offset));
  }

  void check(const tinygltf::Accessor& accessor) const {
    expect(component_bytes(accessor.componentType) > 0, "a componentType of glTF", accessor.componentType);
    const int n = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    expect(n > 0, "a type of glTF", accessor.type);
    const ElementLayout layout(accessor);
    const std::size_t element_bytes = layout.size();
    expect(accessor.count > 0, "a count of at least 1", accessor.count);
    if (accessor.bufferView >= 0) {
      check_elements(accessor.bufferView, 0, 1, 1, 0);
      const std::size_t stride = model_.bufferViews[index_of(accessor.bufferView)].byteStride;
      expect(stride == 0 || (stride >= element_bytes && stride <= 252),
             fmt::format("a byteStride of {} to 252", element_bytes), stride);
      check_elements(accessor.bufferView, accessor.byteOffset, accessor.count,
                     stride == 0 ? layout.stride() : stride, element_bytes);
    } else {
      // All zeros, or zeros with sparse values: nothing in the file holds the count, so it is held to the
      // file.
      expect(accessor.count <= std::max<std::size_t>(n_file_bytes_, 65536),
             "a count that the file can hold, as the accessor has no buffer view", accessor.count);
    }
    if (accessor.sparse.isSparse) check_sparse(accessor, layout);
  }

  void check_sparse(const tinygltf::Accessor& accessor, const ElementLayout& layout) const {
    const auto& sparse = accessor.sparse;
    expect(sparse.count > 0 && index_of(sparse.count) <= accessor.count,
           fmt::format("a sparse count of 1 to {}", accessor.count), sparse.count);
    expect(sparse.indices.byteOffset >= 0 && sparse.values.byteOffset >= 0, "sparse offsets of at least 0",
           "a negative one");
    const int type = sparse.indices.componentType;
    expect(gltf::is_unsigned(type), "sparse indices of an unsigned componentType", type);
    const std::size_t index_bytes = component_bytes(type);
    check_elements(sparse.indices.bufferView, index_of(sparse.indices.byteOffset), index_of(sparse.count),
                   index_bytes, index_bytes);
    check_elements(sparse.values.bufferView, index_of(sparse.values.byteOffset), index_of(sparse.count),
                   layout.stride(), layout.size());
    const unsigned char* indices = view_begin(model_, sparse.indices.bufferView) + sparse.indices.byteOffset;
    std::uint64_t least = 0;
    for (std::size_t i = 0; i < index_of(sparse.count); ++i) {
      const std::uint32_t at = load_unsigned(indices + i * index_bytes, type);
      expect(at >= least && at < accessor.count,
             fmt::format("rising sparse indices from {} to below {}", least, accessor.count), at);
      least = std::uint64_t{at} + 1;
    }
  }

  const std::string& path_;
  const tinygltf::Model& model_;
  std::string where_;
  std::size_t n_file_bytes_ = 0;
};

/// Finds the bytes of an accessor's elements: in its view, among its sparse values, or zeros.
class ElementReader {
 public:
  ElementReader(const tinygltf::Model& model, const tinygltf::Accessor& accessor)
      : size_(ElementLayout(accessor).size()), packed_stride_(ElementLayout(accessor).stride()) {
    if (accessor.bufferView >= 0) {
      const std::size_t view_stride = model.bufferViews[index_of(accessor.bufferView)].byteStride;
      stride_ = view_stride == 0 ? packed_stride_ : view_stride;
      dense_ = view_begin(model, accessor.bufferView) + accessor.byteOffset;
    }
    if (!accessor.sparse.isSparse) return;
    const auto& indices = accessor.sparse.indices;
    const auto& values = accessor.sparse.values;
    n_sparse_ = index_of(accessor.sparse.count);
    index_type_ = indices.componentType;
    sparse_indices_ = view_begin(model, indices.bufferView) + indices.byteOffset;
    sparse_values_ = view_begin(model, values.bufferView) + values.byteOffset;
  }

  /// n elements without gaps; the i-th is number `element_of(i)`.
  template <typename ElementOf>
  std::vector<unsigned char> gather(std::size_t n, const ElementOf& element_of) const {
    std::vector<unsigned char> bytes(n * packed_stride_);
    for (std::size_t i = 0; i < n; ++i)
      if (const unsigned char* from = find(element_of(i)))
        std::memcpy(bytes.data() + i * packed_stride_, from, size_);
    return bytes;
  }

 private:
  /// Null where nothing but zeros is meant.
  const unsigned char* find(std::size_t element) const {
    const auto sparse_index = [&](std::size_t i) -> std::size_t {
      return load_unsigned(sparse_indices_ + i * component_bytes(index_type_), index_type_);
    };
    const auto all = std::views::iota(std::size_t{0}, n_sparse_);
    const auto at = std::ranges::lower_bound(all, element, {}, sparse_index);
    if (at != all.end() && sparse_index(*at) == element) return sparse_values_ + *at * packed_stride_;
    return dense_ == nullptr ? nullptr : dense_ + element * stride_;
  }

  std::size_t size_ = 0, packed_stride_ = 0, stride_ = 0;
  const unsigned char* dense_ = nullptr;
  std::size_t n_sparse_ = 0;
  int index_type_ = 0;
  const unsigned char* sparse_indices_ = nullptr;  ///< Rising, as check_accessors() holds.
  const unsigned char* sparse_values_ = nullptr;
};

std::vector<float> floats_of(const tinygltf::Accessor& accessor, const std::vector<unsigned char>& bytes) {
  const ElementLayout layout(accessor);
  const std::size_t n_columns = bytes.size() / layout.column_stride;
  std::vector<float> values;
  values.reserve(n_columns * layout.n_rows);
  for (std::size_t column = 0; column < n_columns; ++column)
    for (std::size_t row = 0; row < layout.n_rows; ++row)
      values.push_back(
          load_float(bytes.data() + column * layout.column_stride + row * layout.n_component_bytes,
                     accessor.componentType, accessor.normalized));
  return values;
}

}  // namespace

std::size_t component_bytes(int component_type) {
  switch (component_type) {
    case gltf::byte:
    case gltf::unsigned_byte:
      return 1;
    case gltf::short_:
    case gltf::unsigned_short:
      return 2;
    case gltf::unsigned_int:
    case gltf::float_:
      return 4;
    default:
      return 0;
  }
}

float load_float(const unsigned char* bytes, int component_type, bool is_normalized) {
  const auto scaled = [is_normalized](float value, float max) {
    return is_normalized ? std::max(value / max, -1.0f) : value;
  };
  switch (component_type) {
    case gltf::byte:
      return scaled(load<std::int8_t>(bytes), 127);
    case gltf::unsigned_byte:
      return scaled(load<std::uint8_t>(bytes), 255);
    case gltf::short_:
      return scaled(load<std::int16_t>(bytes), 32767);
    case gltf::unsigned_short:
      return scaled(load<std::uint16_t>(bytes), 65535);
    case gltf::unsigned_int:
      return scaled(static_cast<float>(load<std::uint32_t>(bytes)), 4294967295.0f);
    default:
      return load<float>(bytes);
  }
}

void check_accessors(const std::string& path, const tinygltf::Model& model) {
  AccessorCheck(path, model).run();
}

std::size_t n_components_of(const tinygltf::Accessor& accessor) {
  return index_of(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
}

std::vector<unsigned char> decode_bytes(const tinygltf::Model& model, std::size_t index) {
  const ElementReader reader(model, model.accessors[index]);
  return reader.gather(model.accessors[index].count, [](std::size_t i) { return i; });
}

std::vector<unsigned char> decode_bytes(const tinygltf::Model& model, std::size_t index,
                                        std::span<const std::uint32_t> elements) {
  const ElementReader reader(model, model.accessors[index]);
  return reader.gather(elements.size(), [&](std::size_t i) { return elements[i]; });
}

std::vector<float> decode_floats(const tinygltf::Model& model, std::size_t index) {
  return floats_of(model.accessors[index], decode_bytes(model, index));
}

std::vector<float> decode_floats(const tinygltf::Model& model, std::size_t index,
                                 std::span<const std::uint32_t> elements) {
  return floats_of(model.accessors[index], decode_bytes(model, index, elements));
}

std::vector<std::uint32_t> decode_unsigned(const tinygltf::Model& model, std::size_t index) {
  const tinygltf::Accessor& accessor = model.accessors[index];
  const std::vector<unsigned char> bytes = decode_bytes(model, index);
  const std::size_t n_bytes = component_bytes(accessor.componentType);
  std::vector<std::uint32_t> values(bytes.size() / n_bytes);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = load_unsigned(bytes.data() + i * n_bytes, accessor.componentType);
  return values;
}

}  // namespace lambake
