# Rooms.cmake: a room is a folder of sources with one idea and one target. Its link list says which rooms it may use, and
# all link lists together are the order of docs/developer/architecture.md, which tests/architecture checks.

# tangi_room([COLD] HEADERS … SOURCES … VECTOR … LINK … PRIVATE …), in the room's folder A/B: the library tangi::A_B.
#   COLD     of texts, files and windows rather than pixels: -O1 compiles it in three quarters of the time, and
#            with the sanitizers -Og in seven tenths
#   VECTOR   those of SOURCES whose loops are to become vector instructions (TP_VECTOR_OPTIONS)
#   LINK     rooms and packages that the headers show; PRIVATE: packages that only the sources use
function(tangi_room)
    cmake_parse_arguments(ARG "COLD" "" "HEADERS;SOURCES;VECTOR;LINK;PRIVATE" ${ARGN})
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
    string(REPLACE "/" "_" name ${folder})
    set(tangi_room ${name} PARENT_SCOPE)
    set_property(GLOBAL APPEND PROPERTY TANGI_ROOMS ${name})
    if(EMSCRIPTEN)
        tangi_keep_web_sources(ARG_SOURCES)
        tangi_keep_web_sources(ARG_VECTOR)
        tangi_keep_web_targets(ARG_LINK)
        tangi_keep_web_targets(ARG_PRIVATE)
        set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
    endif()
    list(TRANSFORM ARG_HEADERS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE headers)
    set_property(GLOBAL APPEND PROPERTY TANGI_HEADERS ${headers})
    if(NOT ARG_SOURCES)
        add_library(tangi_${name} INTERFACE)
        target_link_libraries(tangi_${name} INTERFACE tangi_common ${ARG_LINK})
        target_sources(tangi_${name} INTERFACE FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
    else()
        add_library(tangi_${name} STATIC ${ARG_SOURCES})
        target_link_libraries(tangi_${name} PUBLIC tangi_common ${ARG_LINK} PRIVATE ${ARG_PRIVATE})
        target_sources(tangi_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
        set_source_files_properties(${ARG_VECTOR} PROPERTIES SKIP_PRECOMPILE_HEADERS ON
                                                             COMPILE_OPTIONS "${TP_VECTOR_OPTIONS}")
        if(ARG_COLD)
            target_compile_options(tangi_${name} PRIVATE $<$<NOT:$<CONFIG:Debug>>:$<IF:$<BOOL:${TP_SANITIZE}>,-Og,-O1>>)
        endif()
        if(name STREQUAL surface_base)
            tangi_precompile(tangi_${name})
        else()
            target_precompile_headers(tangi_${name} REUSE_FROM tangi_surface_base)
        endif()
    endif()
    add_library(tangi::${name} ALIAS tangi_${name})
endfunction()

# tangi_module(<room> …): adds the rooms of this folder, in their order, and tangi::<folder>, which links all of them.
function(tangi_module)
    get_filename_component(module ${CMAKE_CURRENT_SOURCE_DIR} NAME)
    add_library(tangi_${module} INTERFACE)
    add_library(tangi::${module} ALIAS tangi_${module})
    foreach(room IN LISTS ARGN)
        if(EMSCRIPTEN AND NOT ${module}/${room} IN_LIST TP_WEB_ROOMS)
            continue()
        endif()
        add_subdirectory(${room})
        target_link_libraries(tangi_${module} INTERFACE tangi::${module}_${room})
    endforeach()
endfunction()

# tangi_embed(HEADER <file.h> NAME <kConstant> FILES … [BEGIN <line>] [SCRIPTS …]): files of this room as one string
# literal in the generated header <room>/<file.h>. BEGIN comes before them; SCRIPTS, modules of JavaScript, take the place of
# {{script}} as one.
function(tangi_embed)
    cmake_parse_arguments(ARG "" "HEADER;NAME;BEGIN" "FILES;SCRIPTS" ${ARGN})
    set(TP_TEXT "")
    if(ARG_BEGIN)
        set(TP_TEXT "${ARG_BEGIN}\n")
    endif()
    foreach(file IN LISTS ARG_FILES)
        file(READ ${file} part)
        string(APPEND TP_TEXT "${part}")
    endforeach()
    if(ARG_SCRIPTS)
        set(scripts "")
        foreach(file IN LISTS ARG_SCRIPTS)
            file(READ ${file} part)
            # Modules become one script: what they import of each other is there already.
            string(REGEX REPLACE "(^|\n)import [^\n]*" "\\1" part "${part}")
            string(REGEX REPLACE "(^|\n)export " "\\1" part "${part}")
            string(APPEND scripts "${part}")
        endforeach()
        string(REPLACE "{{script}}" "${scripts}" TP_TEXT "${TP_TEXT}")
    endif()
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${folder}/${ARG_HEADER} @ONLY CONTENT
"// @ARG_HEADER@: made by CMake from files of @folder@/.
#pragma once

constexpr const char* @ARG_NAME@ = R\"tangi-text(@TP_TEXT@)tangi-text\";
")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARG_FILES} ${ARG_SCRIPTS})
endfunction()

# tangi_embed_each(HEADER <file.h> NAMESPACE <name> FILES …): as tangi_embed, but each file is a string literal of its own in
# that namespace, called as the file is without its extension.
function(tangi_embed_each)
    cmake_parse_arguments(ARG "" "HEADER;NAMESPACE" "FILES" ${ARGN})
    set(TP_TEXT "")
    foreach(file IN LISTS ARG_FILES)
        file(READ ${file} part)
        get_filename_component(name ${file} NAME_WE)
        string(APPEND TP_TEXT "constexpr const char* ${name} = R\"tangi-text(${part})tangi-text\";\n")
    endforeach()
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${folder}/${ARG_HEADER} @ONLY CONTENT
"// @ARG_HEADER@: made by CMake, for @folder@/.
#pragma once

namespace tangi::@ARG_NAMESPACE@ {

@TP_TEXT@
}  // namespace tangi::@ARG_NAMESPACE@
")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARG_FILES})
endfunction()
