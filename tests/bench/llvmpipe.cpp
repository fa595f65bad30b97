#include "llvmpipe.h"

#include <GL/gl.h>
#include <GL/glext.h>

#include <cmath>
#include <stdexcept>
#include <string>

namespace lambake::bench {
namespace {

template <typename Function>
Function gl(const char* name) {
  const OSMESAproc address = OSMesaGetProcAddress(name);
  if (address == nullptr) throw std::runtime_error(std::string("Mesa has no ") + name);
  return reinterpret_cast<Function>(address);
}

constexpr const char* vertex_source = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_world;
out vec3 world;
out vec3 world_normal;
void main() {
  world = position;
  world_normal = normal;
  gl_Position = clip_from_world * vec4(position, 1.0);
})";

std::string fragment_source(std::size_t n_lights) {
  return "#version 330 core\n#define N " + std::to_string(n_lights) + R"(
in vec3 world;
in vec3 world_normal;
uniform vec3 place[N];
uniform vec3 intensity[N];
out vec4 color;
void main() {
  vec3 n = normalize(world_normal);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < N; ++i) {
    vec3 to_light = place[i] - world;
    float d2 = dot(to_light, to_light);
    sum += intensity[i] * (max(dot(n, to_light), 0.0) * inversesqrt(d2) / d2);
  }
  color = vec4(sum, 1.0);
})";
}

GLuint compile(GLenum stage, const std::string& source) {
  const GLuint shader = gl<PFNGLCREATESHADERPROC>("glCreateShader")(stage);
  const char* text = source.c_str();
  gl<PFNGLSHADERSOURCEPROC>("glShaderSource")(shader, 1, &text, nullptr);
  gl<PFNGLCOMPILESHADERPROC>("glCompileShader")(shader);
  GLint is_good = 0;
  gl<PFNGLGETSHADERIVPROC>("glGetShaderiv")(shader, GL_COMPILE_STATUS, &is_good);
  if (is_good == 0) throw std::runtime_error("Mesa did not compile the shader");
  return shader;
}

void upload(GLenum target, const void* data, std::size_t n_bytes) {
  GLuint buffer = 0;
  gl<PFNGLGENBUFFERSPROC>("glGenBuffers")(1, &buffer);
  gl<PFNGLBINDBUFFERPROC>("glBindBuffer")(target, buffer);
  gl<PFNGLBUFFERDATAPROC>("glBufferData")(target, static_cast<GLsizeiptr>(n_bytes), data, GL_STATIC_DRAW);
}

void upload_attribute(GLuint location, const std::vector<glm::vec3>& values) {
  upload(GL_ARRAY_BUFFER, values.data(), values.size() * sizeof(glm::vec3));
  gl<PFNGLVERTEXATTRIBPOINTERPROC>("glVertexAttribPointer")(location, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  gl<PFNGLENABLEVERTEXATTRIBARRAYPROC>("glEnableVertexAttribArray")(location);
}

glm::mat4 clip_from_world(const Camera& camera, double aspect) {
  const double f = 1 / std::tan(0.5 * double(camera.vertical_fov_rad));
  const double near = camera.near_distance, far = 1e4 * near;
  glm::dmat4 projection(0);
  projection[0][0] = f / aspect;
  projection[1][1] = f;
  projection[2][2] = (far + near) / (near - far);
  projection[2][3] = -1;
  projection[3][2] = 2 * far * near / (near - far);
  return glm::mat4(projection * glm::inverse(glm::dmat4(camera.world_from_camera)));
}

}  // namespace

Llvmpipe::Llvmpipe(const Scene& scene, const Camera& camera, std::uint32_t width, std::uint32_t height)
    : n_indices_(static_cast<std::uint32_t>(3 * scene.mesh.n_triangles())),
      pixels_(std::size_t{4} * width * height) {
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            24,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  context_ = OSMesaCreateContextAttribs(attributes, nullptr);
  if (context_ == nullptr ||
      OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, static_cast<GLsizei>(width),
                        static_cast<GLsizei>(height)) == 0)
    throw std::runtime_error("Mesa gives no off-screen context of OpenGL 3.3");

  const GLuint program = gl<PFNGLCREATEPROGRAMPROC>("glCreateProgram")();
  const auto attach = gl<PFNGLATTACHSHADERPROC>("glAttachShader");
  attach(program, compile(GL_VERTEX_SHADER, vertex_source));
  attach(program, compile(GL_FRAGMENT_SHADER, fragment_source(scene.lights.size())));
  gl<PFNGLLINKPROGRAMPROC>("glLinkProgram")(program);
  gl<PFNGLUSEPROGRAMPROC>("glUseProgram")(program);

  const auto location = [&](const char* name) {
    return gl<PFNGLGETUNIFORMLOCATIONPROC>("glGetUniformLocation")(program, name);
  };
  const glm::mat4 matrix = clip_from_world(camera, double(width) / height);
  gl<PFNGLUNIFORMMATRIX4FVPROC>("glUniformMatrix4fv")(location("clip_from_world"), 1, GL_FALSE,
                                                      &matrix[0][0]);
  std::vector<glm::vec3> places, intensities;
  for (const Light& light : scene.lights) {
    places.push_back(light.position);
    intensities.emplace_back(light.intensity.r, light.intensity.g, light.intensity.b);
  }
  const GLsizei n = static_cast<GLsizei>(places.size());
  const auto set_vectors = gl<PFNGLUNIFORM3FVPROC>("glUniform3fv");
  set_vectors(location("place"), n, &places[0].x);
  set_vectors(location("intensity"), n, &intensities[0].x);

  GLuint array = 0;
  gl<PFNGLGENVERTEXARRAYSPROC>("glGenVertexArrays")(1, &array);
  gl<PFNGLBINDVERTEXARRAYPROC>("glBindVertexArray")(array);
  upload_attribute(0, scene.mesh.positions);
  upload_attribute(1, scene.mesh.normals);
  upload(GL_ELEMENT_ARRAY_BUFFER, scene.mesh.triangles.data(), n_indices_ * sizeof(std::uint32_t));
  glEnable(GL_DEPTH_TEST);
  glViewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
}

Llvmpipe::~Llvmpipe() {
  OSMesaDestroyContext(context_);
}

void Llvmpipe::draw() {
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(n_indices_), GL_UNSIGNED_INT, nullptr);
  glFinish();
}

}  // namespace lambake::bench
