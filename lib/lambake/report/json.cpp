#include <cmath>
#include <nlohmann/json.hpp>

#include "lambake/report/report.h"

namespace lambake {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity and no NaN: docs/report.schema.json says what null means for each key.
Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json image_json(const ImageError& e) {
  return {{"rmse", finite_or_null(e.rmse)},
          {"mae", finite_or_null(e.mae)},
          {"mean", finite_or_null(e.mean)},
          {"max", finite_or_null(e.max)},
          {"max_pixel", {e.max_x, e.max_y}},
          {"psnr_db", finite_or_null(e.psnr_db)},
          {"p99", finite_or_null(e.p99)},
          {"pixels", e.pixels},
          {"pixels_over_1_255", e.pixels_over_1_255},
          {"nonfinite_samples", e.nonfinite}};
}

Json surface_json(const SurfaceError& e, const std::optional<double>& max_bound) {
  Json json = {{"rmse", finite_or_null(e.rmse)},
               {"mae", finite_or_null(e.mae)},
               {"mean", finite_or_null(e.mean)},
               {"max_sampled", finite_or_null(e.max_sampled)}};
  if (max_bound) json["max_bound"] = finite_or_null(*max_bound);
  json["area"] = finite_or_null(e.area);
  return json;
}

Json place_json(const SurfacePlace& place) {
  const auto vector = [](const glm::dvec3& v) {
    return Json{finite_or_null(v.x), finite_or_null(v.y), finite_or_null(v.z)};
  };
  return {{"face", place.source_face},
          {"triangle", place.triangle},
          {"barycentrics", vector(place.barycentrics)},
          {"position", vector(place.position)},
          {"error", finite_or_null(place.error)},
          {"light", place.light}};
}

}  // namespace

std::string report_json(const Comparison& c) {
  Json json;
  json["input"] = c.input;
  json["command"] = c.command;
  json["version"] = c.version;
  json["method"] = c.method;
  json["normals"] = c.normals;
  if (!c.verdict.empty()) json["verdict"] = c.verdict;
  if (!c.trials.empty()) {
    json["trials"] = Json::array();
    for (const MethodTrial& t : c.trials)
      json["trials"].push_back({{"method", name_of(t.method)},
                                {"vertices", t.n_vertices},
                                {"triangles", t.n_triangles},
                                {"bytes", t.bytes},
                                {"seconds", t.seconds},
                                {"rmse", finite_or_null(t.rmse)},
                                {"max_sampled", finite_or_null(t.max_found)},
                                {"max_bound", finite_or_null(t.max_bound)},
                                {"certified", t.is_certified}});
  }
  json["vertices"] = c.n_vertices;
  json["triangles"] = c.n_triangles;
  json["scene_vertices"] = c.n_scene_vertices;
  json["scene_triangles"] = c.n_scene_triangles;
  json["lights"] = c.n_lights;
  json["light_names"] = c.light_names;
  if (!c.light_shares.empty()) {
    json["light_shares"] = Json::array();
    for (const LightShare& share : c.light_shares)
      json["light_shares"].push_back({{"light", share.light}, {"error", share.error}});
  }
  json["views"] = c.n_views;
  json["image"] = {{"linear", image_json(c.image_linear)}, {"display", image_json(c.image_display)}};
  json["image"]["display"]["histogram"] = c.image_display.histogram;
  json["surface"] = {{"linear", surface_json(c.surface_linear, c.max_bound_linear)},
                     {"display", surface_json(c.surface_display, c.max_bound_display)}};
  json["heat_map_scale"] = heat_map_scale(c.per_vertex, c.per_fragment, c.visibility);
  json["error_shares"] = {{"interpolation", finite_or_null(c.shares.interpolation)},
                          {"clipping", finite_or_null(c.shares.clipping.value_or(NAN))},
                          {"quantisation", finite_or_null(c.shares.quantisation.value_or(NAN))}};
  const std::vector<SurfacePlace>& worst = c.surface_display.worst;
  json["max_at"] = worst.empty() ? Json(nullptr) : place_json(worst.front());
  json["worst"] = Json::array();
  for (const SurfacePlace& place : worst) json["worst"].push_back(place_json(place));
  json["clipped_vertices"] = c.clipped_vertices;
  json["pixels_seen_from_behind"] = c.seen_from_behind;
  json["findings"] = Json::array();
  for (const Finding& f : c.findings)
    json["findings"].push_back({{"code", f.code}, {"count", f.count}, {"text", f.text}});
  json["seconds"] = Json::object();
  for (const auto& [stage, seconds] : c.seconds) {
    Json& sum = json["seconds"][stage];
    sum = (sum.is_null() ? 0.0 : sum.get<double>()) + seconds;
  }
  // Names of files and lights need not be UTF-8; JSON is: other bytes become U+FFFD.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace lambake
