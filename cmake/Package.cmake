# Package.cmake: the package for Debian (CPack), as script/package makes it; the rest of what is in it is in Install.cmake.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tangipaint)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "relightable digital twins of paintings from photographs")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"From photographs of a painting under many lights, TangiPaint fits for each
pixel the normal, the height and the reflectance. The result is relit,
measured, compared with photographs, painted on and retouched.
.
The package holds the program, the C++ library and the Python module.")
set(TP_MAINTAINER "" CACHE STRING "Name <address> of who makes packages")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${TP_MAINTAINER}")
set(CPACK_PACKAGE_CONTACT "${TP_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The module is of one version of Python's interface.
execute_process(COMMAND /usr/bin/python3 -c "import sys; v, n = sys.version_info[:2]; print(f'python3 (>= {v}.{n}), python3 (<< {v}.{n + 1})', end='')"
                OUTPUT_VARIABLE python)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "${python}, python3-numpy")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "fonts-dejavu-core, libgl1-mesa-dri")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
file(WRITE ${PROJECT_BINARY_DIR}/install/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/install/triggers)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/install/AsDebianWants.cmake)
include(CPack)
