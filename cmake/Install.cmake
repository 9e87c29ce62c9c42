# Install.cmake: what `cmake --install` puts below a prefix: the program with its man pages and completions, the library
# with its headers, CMake and pkg-config descriptions, the sample and the shaders, desktop entry, icon and file type.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(TP_SHARE ${CMAKE_INSTALL_DATADIR}/tangipaint)
set(TP_ZSH_FOLDER ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING "Where zsh looks for completions")

# The library: all rooms but those of the window and of the program, whose headers are those of the rooms.
get_property(rooms GLOBAL PROPERTY TANGI_ROOMS)
list(FILTER rooms EXCLUDE REGEX "^(viewer|cli)_|^(cli|python)$")
add_library(tangi_library SHARED)
foreach(room IN LISTS rooms)
    get_target_property(kind tangi_${room} TYPE)
    if(kind STREQUAL "STATIC_LIBRARY")
        target_sources(tangi_library PRIVATE $<TARGET_OBJECTS:tangi_${room}>)
    endif()
    target_link_libraries(tangi_library PRIVATE tangi_${room})
endforeach()
get_property(headers GLOBAL PROPERTY TANGI_HEADERS)
list(FILTER headers EXCLUDE REGEX "^${PROJECT_SOURCE_DIR}/(viewer|cli|python)/")
target_sources(tangi_library INTERFACE FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${headers})
target_compile_features(tangi_library INTERFACE cxx_std_20)
target_link_libraries(tangi_library INTERFACE fmt::fmt nlohmann_json::nlohmann_json glm::glm Eigen3::Eigen)
# Before 1.0.0 a minor version may change anything.
set_target_properties(tangi_library PROPERTIES OUTPUT_NAME tangipaint EXPORT_NAME tangipaint VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} LINKER_LANGUAGE CXX
                      VERIFY_INTERFACE_HEADER_SETS OFF)

install(TARGETS tangipaint COMPONENT program)
install(TARGETS tangi_library EXPORT TangiPaintTargets
        LIBRARY COMPONENT program NAMELINK_COMPONENT development
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tangipaint COMPONENT development)
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/TangiPaint)
install(EXPORT TangiPaintTargets NAMESPACE TangiPaint:: DESTINATION ${config} COMPONENT development)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/install/TangiPaintConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/install/TangiPaintConfig.cmake ${PROJECT_BINARY_DIR}/install/TangiPaintConfigVersion.cmake
        DESTINATION ${config} COMPONENT development)
file(RELATIVE_PATH TP_UP /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/install/tangipaint.pc.in install/tangipaint.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/install/tangipaint.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
        COMPONENT development)

# What --help says, as man pages and completions.
set(pages ${PROJECT_BINARY_DIR}/install/pages)
install(CODE "execute_process(COMMAND $<TARGET_FILE:tangipaint> help --pages ${pages} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)"
        COMPONENT program)
install(DIRECTORY ${pages}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
install(DIRECTORY ${pages}/zsh/site-functions/ DESTINATION ${TP_ZSH_FOLDER} COMPONENT program)
install(DIRECTORY ${pages}/bash-completion ${pages}/fish DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT program)

install(DIRECTORY datasets/impasto/jpg DESTINATION ${TP_SHARE}/datasets/impasto COMPONENT program)
install(FILES datasets/impasto/README.md DESTINATION ${TP_SHARE}/datasets/impasto COMPONENT program)
install(DIRECTORY datasets/strokes DESTINATION ${TP_SHARE}/datasets COMPONENT program)
install(DIRECTORY shaders DESTINATION ${TP_SHARE} COMPONENT program)
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/tangipaint COMPONENT program)

install(FILES cmake/install/tangipaint.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT program)
install(FILES cmake/install/tangipaint.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps
        COMPONENT program)
install(FILES cmake/install/tangipaint.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages COMPONENT program)
include(Package)
