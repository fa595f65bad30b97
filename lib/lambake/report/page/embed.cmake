# Writes OUTPUT, a C++ source that holds the FILES (a list) as string constants of lambake::page_assets.
# usage: cmake -D OUTPUT=assets.cpp -D "FILES=page.css;page.js" -P embed.cmake
set(source "#include \"lambake/report/page_assets.h\"\n\nnamespace lambake::page_assets {\n\n")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  string(MAKE_C_IDENTIFIER ${name} name)
  file(READ ${file} text)
  string(APPEND source "const std::string_view ${name} = R\"asset(${text})asset\";\n\n")
endforeach()
string(APPEND source "}  // namespace lambake::page_assets\n")
file(WRITE ${OUTPUT} "${source}")
