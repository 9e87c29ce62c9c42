# AsDebianWants.cmake: changes what CPack has installed to what Debian's policy says: pages of manuals and changes are
# compressed, the licence is called copyright.
cmake_policy(SET CMP0007 NEW)  # empty lines of the licence are kept
set(share ${CPACK_TEMPORARY_DIRECTORY}/usr/share)
set(doc ${share}/doc/tangipaint)
file(STRINGS ${doc}/LICENSE licence)
list(TRANSFORM licence PREPEND " ")
list(TRANSFORM licence REPLACE "^ $" " .")
list(JOIN licence "\n" licence)
file(WRITE ${doc}/copyright
     "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: TangiPaint\n\n"
     "Files: *\nCopyright: the TangiPaint authors\nLicense: Expat\n${licence}\n\n"
     "Files: usr/share/tangipaint/datasets/*\nCopyright: none\nLicense: CC0-1.0\n On Debian systems, the text of CC0 1.0 is in\n"
     " /usr/share/common-licenses/CC0-1.0.\n")
file(REMOVE ${doc}/LICENSE)
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${doc}/changelog "tangipaint (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n  * See CHANGELOG.md.\n\n"
     " -- ${CPACK_PACKAGE_CONTACT}  ${now}\n")
file(GLOB pages ${share}/man/man1/*.1)
foreach(file ${pages} ${doc}/changelog)
    execute_process(COMMAND gzip -9n ${file} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
