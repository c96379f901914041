# Read by cpack: the version of a package names the commit that the programs in it were built from, as --version does.
# Sources without a repository have none. An older package beside it would be taken by `apt install ./stiltd_*.deb`.
file(STRINGS ${CPACK_STILT_COMMIT_SOURCE} commit REGEX "In the version of a package: ")
string(REGEX REPLACE ".*: *" "" commit "${commit}")
string(REPLACE "+deb" "${commit}+deb" CPACK_PACKAGE_VERSION ${CPACK_PACKAGE_VERSION})
set(folder ${CPACK_PACKAGE_DIRECTORY})
file(GLOB older ${folder}/stilt_*.deb ${folder}/stiltd_*.deb ${folder}/libstilt-dev_*.deb)
if(older)
  file(REMOVE ${older})
endif()
