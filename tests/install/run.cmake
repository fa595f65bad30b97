# Installs into a scratch prefix, then configures, builds and runs a consumer against what lies there.
# The consumer is the sample of README.md.
# usage: cmake -DREADME=... -DBUILD=<build folder> -DCONSUMER=<source> -DFOLDER=<scratch> -DGENERATOR=... -DCOMPILER=...
#              -DBUILD_TYPE=... -P run.cmake
file(REMOVE_RECURSE ${FOLDER})
file(READ ${README} text)
string(REGEX MATCH "```cpp\n([^`]*)```" sample "${text}")
file(WRITE ${FOLDER}/readme_sample.inc "${CMAKE_MATCH_1}")
# A flat square, facing up.
file(WRITE ${FOLDER}/model.ply "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
     "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
     "0 0 0\n0 0 1\n1 0 1\n1 0 0\n4 0 1 2 3\n")
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${FOLDER}/prefix
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(GLOB_RECURSE headers RELATIVE ${FOLDER}/prefix/include ${FOLDER}/prefix/include/lambake/*.h)
list(TRANSFORM headers REPLACE "(.+)" "#include \"\\1\"\n")
file(WRITE ${FOLDER}/installed_headers.inc ${headers})
execute_process(COMMAND ${CMAKE_COMMAND} -S ${CONSUMER} -B ${FOLDER}/build -G ${GENERATOR}
                        -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=${BUILD_TYPE}
                        -DCMAKE_PREFIX_PATH=${FOLDER}/prefix "-DCMAKE_CXX_FLAGS=${FLAGS} -I${FOLDER}"
                COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${FOLDER}/build COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${FOLDER}/build/consumer WORKING_DIRECTORY ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${FOLDER}/prefix/bin/lambake --version COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${FOLDER}/prefix/bin/lambake render ${FOLDER}/model.ply --size 8x8 -o ${FOLDER}/tool.png
                OUTPUT_QUIET ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
# Both have written a picture, by the installed module and not by that of the build.
foreach(picture IN ITEMS tool.png consumer.png)
  file(READ ${FOLDER}/${picture} signature LIMIT 4 HEX)
  if(NOT signature STREQUAL "89504e47")
    message(FATAL_ERROR "${picture}: expected a PNG")
  endif()
endforeach()
file(GLOB module ${FOLDER}/prefix/*/*lambake_image_codec* ${FOLDER}/prefix/*/*/*lambake_image_codec*)
file(RENAME ${module} ${FOLDER}/elsewhere)
foreach(program IN ITEMS "${FOLDER}/build/consumer" "${FOLDER}/prefix/bin/lambake;render;model.ply;-o;none.png")
  execute_process(COMMAND ${program} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE error)
  if(NOT code EQUAL 3 OR NOT error MATCHES "pictures cannot be read or written")
    message(FATAL_ERROR "${program}: expected exit code 3 without the module, found ${code}: ${error}")
  endif()
endforeach()
