#include "lambake/io/gltf/parse.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "lambake/io/json_text.h"
#include "lambake/io/text_encoding.h"

namespace lambake {
namespace {

/// Objects of more members than this have a table of their keys while they are read.
constexpr std::size_t most_searched = 16;

class GltfJsonBuilder : public nlohmann::json_sax<GltfJson> {
 public:
  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t& value) override { return put(std::move(value)); }
  bool start_object(std::size_t) override { return begin(GltfJson::object()); }
  bool start_array(std::size_t) override { return begin(GltfJson::array()); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }
  bool key(string_t& key) override {
    value_ = &value_of(open_.back(), key);
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& exception) override {
    error_ = exception.what();
    return false;
  }

  GltfJson take() { return std::move(root_); }
  const std::string& error() const { return error_; }

 private:
  using Members = GltfJson::object_t::Container;

  struct Open {
    GltfJson* json = nullptr;                 ///< Does not move: what holds it does not grow meanwhile.
    std::map<std::string, std::size_t> at{};  ///< Of the keys, where there are many.
  };

  static GltfJson& value_of(Open& open, const std::string& key) {
    Members& members = open.json->get_ref<GltfJson::object_t&>();
    if (members.size() <= most_searched) {
      const auto found = std::find_if(members.begin(), members.end(),
                                      [&](const auto& member) { return member.first == key; });
      if (found != members.end()) return found->second;
    }
    if (members.size() == most_searched)
      for (std::size_t i = 0; i < members.size(); ++i) open.at.emplace(members[i].first, i);
    if (members.size() >= most_searched) {
      const auto [place, is_new] = open.at.emplace(key, members.size());
      if (!is_new) return members[place->second].second;
    }
    return members.emplace_back(key, nullptr).second;
  }

  GltfJson& place() {
    if (open_.empty()) return root_;
    GltfJson& holder = *open_.back().json;
    if (!holder.is_array()) return *value_;
    holder.push_back(nullptr);
    return holder.back();
  }

  bool put(GltfJson value) {
    place() = std::move(value);
    return true;
  }
  bool begin(GltfJson container) {
    GltfJson& json = place();
    json = std::move(container);
    open_.push_back({&json});
    return true;
  }
  bool end() {
    open_.pop_back();
    return true;
  }

  GltfJson root_;
  std::vector<Open> open_;
  GltfJson* value_ = nullptr;  ///< Of the key that was read last.
  std::string error_;
};

}  // namespace

GltfJson parse_gltf_json(std::span<const unsigned char> text, const std::string& path) {
  check_depth(path, as_utf8(path, {reinterpret_cast<const char*>(text.data()), text.size()}));
  GltfJsonBuilder builder;
  if (!GltfJson::sax_parse(text.begin(), text.end(), &builder)) throw_no_json(path, builder.error());
  return builder.take();
}

}  // namespace lambake
