# TangiPaintConfig.cmake: find_package(TangiPaint) gives the target TangiPaint::tangipaint.
include(CMakeFindDependencyMacro)
foreach(package fmt nlohmann_json glm Eigen3)
    find_dependency(${package})
endforeach()
include(${CMAKE_CURRENT_LIST_DIR}/TangiPaintTargets.cmake)
