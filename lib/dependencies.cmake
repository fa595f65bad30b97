# What the library needs, for the build and for whoever finds the installed package.
set(lambake_dependencies draco fmt glm hwy meshoptimizer nlohmann_json OpenMesh TBB TinyGLTF)
