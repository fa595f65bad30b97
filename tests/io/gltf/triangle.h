#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "io/gltf/files.h"
#include "io/gltf/glb_reader.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf.h"

/// A small sound file that tests spoil, and how reading it ends.
namespace lambake {

/// A sound file: one indexed triangle (36 bytes of positions, 6 of indices) under a node, as data URI.
inline nlohmann::ordered_json triangle() {
  return nlohmann::ordered_json::parse(R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
    "buffers": [{"byteLength": 42, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}]
  })");
}

/// Reads text as a .gltf; the message and the exit code of the error, or "" and 0.
inline std::pair<std::string, int> outcome_of(const std::string& text, const std::string& name = "bad.gltf") {
  const std::string path = temporary_file(name);
  write_bytes(path, text);
  try {
    read_gltf_file(path, {});
  } catch (const Error& error) {
    return {error.what(), error.exit_code()};
  }
  return {"", 0};
}

}  // namespace lambake
