# WebEngine.cmake: of which rooms, and of which of their sources, the engine of the web application is made (web/). What it
# takes of the distribution are headers; where it does without a package, web/platform/ has what stands in for it.
set(TP_WEB_ROOMS
    surface/base surface/math surface/file surface/image surface/reflectance surface/maps surface/painting_file surface/render
    paint/optics paint/canvas paint/exchange paint/substrate paint/brush paint/stroke paint/session paint/files
    viewer/render viewer/model viewer/web
    web/engine)

# Of these rooms only these sources: the others are about files, packages and devices that a browser does not have.
set(TP_WEB_SOURCES
    surface/base/json_reading.cpp surface/base/json_text.cpp surface/base/noise.cpp surface/base/renamed_keys.cpp
    surface/file/version.cpp
    surface/image/colour.cpp
    surface/painting_file/surface_channels.cpp
    surface/render/relight.cpp surface/render/cast_shadows.cpp
    paint/optics/film_batch.cpp paint/optics/kubelka_munk.cpp paint/optics/palette.cpp paint/optics/pigment.cpp
    paint/optics/spectrum.cpp
    paint/files/canvas_parts.cpp paint/files/paint_parts.cpp
    paint/session/event_order.cpp paint/session/history.cpp paint/session/journal.cpp paint/session/journal_json.cpp
    paint/session/journal_writer.cpp paint/session/mixing_board.cpp paint/session/session.cpp
    paint/substrate/picture_substrate.cpp paint/substrate/substrate.cpp paint/substrate/substrate_finish.cpp
    viewer/render/horizon.cpp viewer/render/painting_shader.cpp viewer/render/scene.cpp viewer/render/texels.cpp
    viewer/render/view_mode.cpp
    viewer/model/palette_image.cpp
    viewer/web/web_data.cpp)

# Packages of the distribution that are headers only, in a folder of their own: /usr/include as a whole is another system's.
set(headers ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(package fmt glm nlohmann eigen3/Eigen)
    find_path(found ${package} PATHS /usr/include NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH NO_CACHE REQUIRED)
    get_filename_component(name ${package} NAME)
    file(CREATE_LINK ${found}/${package} ${headers}/${name} SYMBOLIC)
    unset(found)
endforeach()
foreach(package fmt::fmt glm::glm nlohmann_json::nlohmann_json Eigen3::Eigen)
    add_library(${package} INTERFACE IMPORTED)
    target_include_directories(${package} SYSTEM INTERFACE ${headers})
endforeach()
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)

# Leave in a list what the engine has: sources of the room in this folder; targets that exist.
function(tangi_keep_web_sources list)
    file(RELATIVE_PATH room ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
    set(chosen ${TP_WEB_SOURCES})
    list(FILTER chosen INCLUDE REGEX "^${room}/")
    set(kept ${${list}})
    list(FILTER kept INCLUDE REGEX "\\.cpp$")
    if(chosen OR room STREQUAL "surface/file")
        list(TRANSFORM kept PREPEND ${room}/)
        foreach(source IN LISTS kept)
            if(NOT source IN_LIST chosen)
                list(REMOVE_ITEM kept ${source})
            endif()
        endforeach()
        list(TRANSFORM kept REPLACE "^.*/" "")
    endif()
    set(${list} "${kept}" PARENT_SCOPE)
endfunction()
function(tangi_keep_web_targets list)
    set(kept "")
    foreach(target IN LISTS ${list})
        if(TARGET ${target})
            list(APPEND kept ${target})
        endif()
    endforeach()
    set(${list} "${kept}" PARENT_SCOPE)
endfunction()
