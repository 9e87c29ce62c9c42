# Tests.cmake: tangi_tests(), which makes programs of tests and tells ctest of them.

# What .ci/run leaves out: measurements on whole stacks and recoveries that take a minute and more, of which shorter tests
# reach the same code. script/test runs them all.
set(TP_LONG_FILES
    capture/registration/registration_data_test.cpp
    capture/spheres/sphere_data_test.cpp
    fit/calibration/light_beams_test.cpp
    fit/calibration/light_calibration_test.cpp
    fit/calibration/light_directions_test.cpp
    fit/calibration/light_pixels_test.cpp
    fit/light_checks/photo_misfit_test.cpp
    fit/material/anisotropy_estimate_test.cpp
    fit/pipeline/data_test.cpp
    fit/pipeline/large_pictures_test.cpp
    fit/pipeline/spheres_test.cpp
    programs/cli/stacks/large_stacks_test.cpp
    programs/cli/stacks/stack_sizes_test.cpp
    programs/cli/workflow_test.cpp
    robustness/further_faults_test.cpp)

# With the sanitizers tests compile in less than half the time without optimisation. What they share with the rooms,
# templates of GLM, Eigen and OpenCV, is linked as they compile it, though: these would take twice as long to run.
set(TP_OPTIMISED_TESTS capture chart compare datasets fit)

# Tests that are about optimised code, and so run there, too, where .ci/run leaves the others to the sanitizers: batches
# against Ceres, sets of instructions, the same bits again, shaders against the processor.
set(TP_OPTIMISED_FILES
    fit/pixel/ward_agreement_test.cpp fit/pixel/ward_batch_test.cpp fit/shadows/shadow_sets_test.cpp
    paint/optics/film_batch_test.cpp paint/stroke/load_rows_test.cpp paint/stroke/stroke_repeats_test.cpp
    surface/image/colour_rows_test.cpp surface/render/visibility_test.cpp viewer/render/renderer_colours_test.cpp
    viewer/render/renderer_test.cpp)

# Filters of gtest for the tests of a file: those that the sanitizers run (<file>_plain), those that are too long for them
# (<file>_long: marked TP_LONG), and those that need data that is not in the repository, in suites named Data* (<file>_data).
function(tangi_sort_tests file)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(READ ${file} text)
    string(REGEX MATCHALL "\n(TP_LONG )?TEST(_[FP])?\\([A-Za-z0-9_]+,[ \n]*[A-Za-z0-9_]+\\)" tests "${text}")
    set(plain "")
    set(long "")
    set(data "")
    foreach(test IN LISTS tests)
        string(REGEX REPLACE "\n[^(]*\\(([A-Za-z0-9_]+),[ \n]*([A-Za-z0-9_]+)\\)" "\\1.\\2" name "${test}")
        set(filter ":${name}")
        if(test MATCHES "TEST_P")
            set(filter ":*/${name}/*")
        endif()
        set(kind plain)
        if(test MATCHES "TP_LONG")
            set(kind long)
        endif()
        if(name MATCHES "^Data")
            set(kind data)
        endif()
        string(APPEND ${kind} "${filter}")
    endforeach()
    foreach(kind plain long data)
        set(${file}_${kind} "${${kind}}" PARENT_SCOPE)
    endforeach()
endfunction()

# tangi_register(<program> <file>): what ctest should know of a file of tests, by its path below tests/: one entry for
# all of it, since loading the libraries takes a program longer than most tests take, and one with the label `data`
# (ctest -LE data leaves them out). What computes counts as two: ctest --parallel 5 runs two of them at a time beside one of
# the window's tests, which wait most of their time, or five of these.
function(tangi_register program file)
    file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR}/tests ${CMAKE_CURRENT_SOURCE_DIR}/${file})
    string(REGEX REPLACE "_test.cpp$" "" entry "${path}")
    set(length "")
    # The sanitizers have the plain tests of a file that marks its long ones.
    if(path IN_LIST TP_LONG_FILES AND NOT (TP_SANITIZE AND ${file}_long))
        set(length long)
    endif()
    set(filter "${${file}_plain}${${file}_long}")
    if(TP_SANITIZE)
        set(filter "${${file}_plain}")
    elseif(TP_TESTS STREQUAL "REST" AND NOT path IN_LIST TP_OPTIMISED_FILES)
        set(filter "${${file}_long}")
    endif()
    if(filter)
        add_test(NAME ${entry} COMMAND ${program}_tests --gtest_brief=1 --gtest_filter=${filter})
        set_tests_properties(${entry} PROPERTIES LABELS "${length}" PROCESSORS 2
                             ENVIRONMENT "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/support/lsan.supp")
    endif()
    if(${file}_data)
        add_test(NAME ${entry}_data COMMAND ${program}_tests --gtest_brief=1 --gtest_filter=${${file}_data})
        set_tests_properties(${entry}_data PROPERTIES LABELS "data;${length}" TIMEOUT 3600 PROCESSORS 2
                             SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
    endif()
endfunction()

# tangi_tests(<program> LINK ... FILES ... [EACH ...] [WHOLE]): <program>_tests of files of this folder. EACH: every test
# is an entry of ctest, with these properties. WHOLE: of those that the sanitizers do not have; else TP_TESTS=REST takes
# only files with tests that they leave out, and of these only such tests.
function(tangi_tests program)
    cmake_parse_arguments(ARG "WHOLE" "" "LINK;FILES;EACH" ${ARGN})
    set(files "")
    foreach(file IN LISTS ARG_FILES)
        tangi_sort_tests(${file})
        file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR}/tests ${CMAKE_CURRENT_SOURCE_DIR}/${file})
        if(ARG_WHOLE AND NOT TP_SANITIZE)
            set(${file}_long "${${file}_plain}${${file}_long}")
            set(${file}_plain "")
        endif()
        if(NOT TP_TESTS STREQUAL "REST" OR ${file}_long OR ${file}_data OR path IN_LIST TP_OPTIMISED_FILES)
            list(APPEND files ${file})
        endif()
    endforeach()
    if(NOT files)
        return()
    endif()
    add_executable(${program}_tests ${files})
    # Tests are compiled often and run once.
    set(optimisation -O1)
    if(TP_SANITIZE AND NOT program IN_LIST TP_OPTIMISED_TESTS)
        set(optimisation -O0)
    endif()
    target_compile_options(${program}_tests PRIVATE $<$<CONFIG:RelWithDebInfo>:${optimisation}$<SEMICOLON>-g1>)
    target_link_libraries(${program}_tests PRIVATE ${ARG_LINK} GTest::gtest_main GTest::gmock)
    if(TP_SANITIZE)
        # -O0 and a precompiled header make GCC 12 take __OPTIMIZE__ for defined, and Eigen does not compile.
    elseif(program STREQUAL layers)  # the first to be made
        tangi_precompile(layers_tests <fstream> <gmock/gmock.h> <gtest/gtest.h>)
    else()
        target_precompile_headers(${program}_tests REUSE_FROM layers_tests)
    endif()
    target_compile_definitions(${program}_tests PRIVATE TP_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    set_target_properties(${program}_tests PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
    if(ARG_EACH)
        # Of real data alone: they wait a minute at most for what takes half of one where nothing else runs.
        gtest_discover_tests(${program}_tests TEST_PREFIX ${program}/ TEST_FILTER "-Data*" DISCOVERY_TIMEOUT 60
                             PROPERTIES ${ARG_EACH})
        gtest_discover_tests(${program}_tests TEST_PREFIX ${program}/ TEST_FILTER "Data*" TEST_LIST ${program}_data
                             DISCOVERY_TIMEOUT 60 PROPERTIES ${ARG_EACH} TIMEOUT 900 LABELS data RUN_SERIAL ON
                             SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
    else()
        foreach(file IN LISTS files)
            tangi_register(${program} ${file})
        endforeach()
    endif()
endfunction()
