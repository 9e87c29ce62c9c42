# Compiler.cmake: language, warnings, sanitizers and speed of building, once for all targets: tangi_common.
find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    # Else ccache takes no file that uses a precompiled header; by the compiler's own list of what a file includes, none
    # is preprocessed for it alone; and clones in other folders share what it keeps.
    set(CMAKE_CXX_COMPILER_LAUNCHER
        ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_DEPEND=1
        CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE})
endif()
add_library(tangi_common INTERFACE)
if(NOT EMSCRIPTEN)
    # A program of ours links in a seventh of the time.
    find_program(LLD ld.lld)
    if(LLD)
        add_link_options(-fuse-ld=lld)
    endif()

    # OpenImageIO brings some 260 libraries into a program, and the loader looks for each of 160 000 symbols in one after the
    # other. Half of them belong to these: where they come first a program starts in half the time.
    get_target_property(oiio OpenImageIO::OpenImageIO LOCATION)
    execute_process(COMMAND ldd ${oiio} OUTPUT_VARIABLE loaded ERROR_QUIET)
    string(REGEX MATCHALL "=> [^ ]+/lib(openvdb|xerces-c|gdal|geos|protobuf|gdcmMSFF|dcmdata|proj|poppler)[-.][^ ]+" first_loaded "${loaded}")
    list(TRANSFORM first_loaded REPLACE "^=> " "")
    target_link_options(tangi_common INTERFACE LINKER:--push-state,--no-as-needed ${first_loaded} LINKER:--pop-state)
endif()
target_compile_features(tangi_common INTERFACE cxx_std_20)
target_include_directories(tangi_common INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/generated)
# The sanitizers' build has nothing to add to the warnings of the other, and is compiled sooner without them.
# Rooms also go into the shared library and the Python module. Functions that are called from their own file are called
# directly, as in a program.
if(NOT EMSCRIPTEN)
    target_compile_options(tangi_common INTERFACE -fPIC -fno-semantic-interposition)
endif()
target_compile_options(tangi_common INTERFACE "$<IF:$<BOOL:${TP_SANITIZE}>,-w,-Wall;-Wextra;-Wshadow>"
                                              $<$<BOOL:${TP_WERROR}>:-Werror>
                                              $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
if(TP_PACKAGE)
    target_compile_options(tangi_common INTERFACE -ffile-prefix-map=${PROJECT_SOURCE_DIR}=.)
endif()
if(CMAKE_UNITY_BUILD)
    # Sources that are compiled together pass for headers there, whose types must not have members of unnamed namespaces.
    target_compile_options(tangi_common INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
# Paint has the same bits on every processor: nothing is fused. The baseline of x86-64 has nothing to fuse with.
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_compile_options(tangi_common INTERFACE -ffp-contract=off)
endif()
if(EMSCRIPTEN)
    # Exceptions and vector instructions of WebAssembly: browsers have both since 2023.
    target_compile_options(tangi_common INTERFACE -msimd128 -fwasm-exceptions
                                                  -include ${PROJECT_SOURCE_DIR}/web/platform/include/missing_in_libcxx.h)
    target_link_options(tangi_common INTERFACE -fwasm-exceptions)
endif()
if(TP_FUZZ)
    # All of ours is compiled so that libFuzzer sees which branches a file took.
    target_compile_options(tangi_common INTERFACE -fsanitize=fuzzer-no-link)
    set(TP_SANITIZE ON)
endif()
if(TP_SANITIZE)
    # Eigen's own allocator in the distribution's Ceres relies on malloc's alignment.
    target_compile_definitions(tangi_common INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
    target_compile_options(tangi_common INTERFACE -fsanitize=address,undefined -fno-omit-frame-pointer
                                                  -fno-sanitize-recover=undefined)
    # As much to compile as all others together, and what they would tell the address sanitizer tells as well.
    target_compile_options(tangi_common INTERFACE -fno-sanitize=null,alignment,object-size,vptr)
    target_link_options(tangi_common INTERFACE -fsanitize=address,undefined)
endif()

# Vector code for several instruction sets, chosen at run time: without Eigen, and products and sums are fused only where
# the source says so. No exception of the floating-point unit is ever looked at. With the sanitizers, -O3 takes three times
# as long to compile as -O1.
set(TP_VECTOR_OPTIONS $<IF:$<BOOL:${TP_SANITIZE}>,-O1,-O3> -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(TP_FUZZ)
    # None of it reads files, and with the sanitizers clang takes over five minutes for one of them, without 16 s.
    list(APPEND TP_VECTOR_OPTIONS -fno-sanitize=all)
endif()

# What nearly every file includes, and what takes long to read where it is included; compiled once for all rooms.
set(TP_PRECOMPILED <algorithm> <cmath> <filesystem> <functional> <memory> <optional> <string> <string_view> <vector>
                   <fmt/format.h> <glm/geometric.hpp> <glm/mat3x3.hpp> <glm/vec2.hpp> <glm/vec3.hpp> <nlohmann/json.hpp>
                   <Eigen/Cholesky> <opencv2/imgproc.hpp>)

function(tangi_precompile target)
    target_include_directories(${target} SYSTEM PRIVATE ${OpenCV_INCLUDE_DIRS} ${EIGEN3_INCLUDE_DIRS})
    target_precompile_headers(${target} PRIVATE ${TP_PRECOMPILED} ${ARGN})
endfunction()
