# A room is a top-level folder with one library. Its headers are reached as "room/header.h", and only
# by targets that link the room: each room has an include root of its own that holds nothing but a
# link to the room's folder. An include that the house forbids therefore does not compile.

# cnc_room(NAME [SOURCES ...] [LINKS ...] [PRECOMPILE ...])
function(cnc_room room)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS;PRECOMPILE" ${ARGN})
  set(root "${CMAKE_BINARY_DIR}/rooms/${room}")
  file(MAKE_DIRECTORY "${root}")
  file(CREATE_LINK "${CMAKE_SOURCE_DIR}/${room}" "${root}/${room}" SYMBOLIC)

  add_library(cnc_${room} STATIC ${ARG_SOURCES})
  target_include_directories(cnc_${room} PUBLIC "${root}")
  target_link_libraries(cnc_${room} PUBLIC ${ARG_LINKS})
  target_compile_options(cnc_${room} PRIVATE ${CNC_WARNINGS})
  if(ARG_PRECOMPILE)
    target_precompile_headers(cnc_${room} PRIVATE ${ARG_PRECOMPILE})
  endif()
endfunction()
