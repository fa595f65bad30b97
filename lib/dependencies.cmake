# What the library needs, for the build and for whoever finds the installed package.
set(lambake_dependencies draco Eigen3 fmt glm hwy meshoptimizer nlohmann_json OpenMesh PkgConfig TBB TinyGLTF)

# Debian's CMake package of OpenImageIO names tools and folders of packages that it does not depend on.
macro(lambake_find_openimageio)
  pkg_check_modules(OpenImageIO REQUIRED IMPORTED_TARGET OpenImageIO)
endmacro()
