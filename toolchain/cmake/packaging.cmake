# Debian packages (toolchain/package): stiltd for the robot's computer, stilt for the host
# (docs/decisions/0012-packages.md).
include(GNUInstallDirs)
set(packaging ${PROJECT_SOURCE_DIR}/toolchain/packaging)
set(made ${PROJECT_BINARY_DIR}/packaging)
set(contact "Stilt contributors <stilt@users.noreply.github.com>")

# Packages of one release of Debian do not install on the next: the libraries have other names.
file(STRINGS /etc/os-release release REGEX "^VERSION_ID=")
string(REGEX MATCH "[0-9.]+" release "${release}")
set(package_version ${PROJECT_VERSION}+deb${release})

# Texts that every Debian package has. The licence texts follow copyright's table, indented by a space.
file(READ ${packaging}/copyright copyright)
file(READ ${PROJECT_SOURCE_DIR}/LICENSE stilt_licence)
set(uplot_licence "Its text is in the pages of stilt.")  # where toolchain/setup has not brought it yet
set(uplot_licence_file ${PROJECT_SOURCE_DIR}/host_tools/web/page/node_modules/uplot/LICENSE)
if(EXISTS ${uplot_licence_file})
  file(READ ${uplot_licence_file} uplot_licence)
endif()
foreach(licence BSD-3-Clause:stilt_licence MIT:uplot_licence)
  string(REPLACE ":" ";" licence ${licence})
  list(GET licence 0 name)
  list(GET licence 1 text)
  string(STRIP "${${text}}" body)
  string(REGEX REPLACE "\n" "\n " body "${body}")
  string(REGEX REPLACE "\n \n" "\n .\n" body "${body}")
  string(APPEND copyright "\nLicense: ${name}\n ${body}\n")
endforeach()
file(WRITE ${made}/copyright "${copyright}")
foreach(package stilt stiltd libstilt-dev)
  file(WRITE ${made}/${package}/changelog "${package} (${package_version}) unstable; urgency=medium

  * See CHANGELOG.md beside this file.

 -- ${contact}  Sun, 22 Nov 2026 00:00:00 +0000
")
  set(compressed changelog)
  if(EXISTS ${packaging}/${package}.1)
    configure_file(${packaging}/${package}.1 ${made}/${package}/${package}.1 COPYONLY)
    list(APPEND compressed ${package}.1)
  endif()
  foreach(file ${compressed})
    execute_process(COMMAND gzip -9nf ${made}/${package}/${file} COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endforeach()

install(TARGETS stiltd DESTINATION bin COMPONENT robot)
install(FILES firmware/configuration/amber3m.toml DESTINATION /etc/stilt RENAME stiltd.toml COMPONENT robot)
install(FILES ${packaging}/stiltd.service ${packaging}/can@.service DESTINATION lib/systemd/system COMPONENT robot)
install(FILES ${packaging}/stiltd.lintian-overrides DESTINATION share/lintian/overrides RENAME stiltd COMPONENT robot)
install(FILES ${packaging}/60-stiltd.rules DESTINATION lib/udev/rules.d COMPONENT robot)
install(FILES ${packaging}/stilt.sysusers DESTINATION lib/sysusers.d RENAME stilt.conf COMPONENT robot)
install(FILES codegen/robots/amber3m.urdf codegen/robots/rabbit.urdf firmware/configuration/rabbit.toml
  DESTINATION share/doc/stiltd/examples COMPONENT robot)

set(component_packages robot:stiltd)
if(TARGET stilt)
  list(APPEND component_packages host:stilt)
  install(TARGETS stilt DESTINATION bin COMPONENT host)
  install(PROGRAMS toolchain/make_security DESTINATION share/stilt COMPONENT host)
  install(DIRECTORY host_tools/python/stilt DESTINATION lib/python3/dist-packages COMPONENT host
    PATTERN __pycache__ EXCLUDE)
  install(DIRECTORY host_tools/ros2/stilt_msgs DESTINATION share/stilt/ros2 COMPONENT host)
endif()

# Documents in the folders of the tree, so that their links among each other hold. Packages have the licence in the
# file copyright.
file(READ README.md readme)
string(REPLACE "[LICENSE](LICENSE)" "[copyright](copyright)" readme "${readme}")
file(WRITE ${made}/README.md "${readme}")
function(install_documents package)
  set(documents share/doc/${package})
  set(options COMPONENT ${ARGN})
  install(DIRECTORY docs DESTINATION ${documents} ${options} PATTERN *.py EXCLUDE)
  install(FILES ${made}/README.md CONTRIBUTING.md CHANGELOG.md DESTINATION ${documents} ${options})
  install(FILES host_tools/python/examples/plot_run.py host_tools/python/examples/compare_runs.py
    host_tools/python/examples/walk_ten_seconds.py
    DESTINATION ${documents}/host_tools/python/examples ${options})
  install(FILES hal/README.md DESTINATION ${documents}/hal ${options})
  install(FILES firmware/telemetry/README.md firmware/telemetry/stilt_msgs.idl firmware/telemetry/ros2.idl
    DESTINATION ${documents}/firmware/telemetry ${options})
  install(FILES firmware/configuration/amber3m.toml DESTINATION ${documents}/firmware/configuration ${options})
  install(FILES ${made}/copyright ${made}/${package}/changelog.gz DESTINATION ${documents} ${options})
endfunction()

foreach(component_package ${component_packages})
  string(REPLACE ":" ";" pair ${component_package})
  list(GET pair 0 component)
  list(GET pair 1 package)
  install_documents(${package} ${component})
  install(FILES ${made}/${package}/${package}.1.gz DESTINATION share/man/man1 COMPONENT ${component})
  install(FILES ${packaging}/stilt.bash-completion DESTINATION share/bash-completion/completions RENAME ${package}
    COMPONENT ${component})
endforeach()

if(TARGET stilt_library)
  install_documents(libstilt-dev library EXCLUDE_FROM_ALL)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR Stilt)
set(CPACK_PACKAGE_CONTACT ${contact})
set(CPACK_PACKAGE_VERSION ${package_version})
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/toolchain/cmake/package_version.cmake)
set(CPACK_STILT_COMMIT_SOURCE ${PROJECT_BINARY_DIR}/firmware/version/commit.cc)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL robot)
if(TARGET stilt)
  list(APPEND CPACK_COMPONENTS_ALL host)
endif()
if(TARGET stilt_library)
  list(APPEND CPACK_COMPONENTS_ALL library)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(CMAKE_CROSSCOMPILING)  # dpkg-shlibdeps finds the machine's own libraries; toolchain/package names the target's
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS OFF)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_ROBOT_PACKAGE_NAME stiltd)
set(CPACK_DEBIAN_ROBOT_DESCRIPTION "controller of a walking robot, for the robot's computer
Whole-body model predictive control of a planar biped, torque loop and
telemetry. Drives motors over CAN.")
set(CPACK_DEBIAN_ROBOT_PACKAGE_CONTROL_EXTRA
  ${made}/conffiles ${packaging}/postinst ${packaging}/prerm ${packaging}/postrm)
set(CPACK_DEBIAN_ROBOT_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_HOST_PACKAGE_NAME stilt)
# The Python package in it; its modules are needed by who uses it alone, openssl by make_security.
set(CPACK_DEBIAN_HOST_PACKAGE_DEPENDS "python3")
set(CPACK_DEBIAN_HOST_PACKAGE_RECOMMENDS
  "openssl, python3-numpy, python3-pandas, python3-zstandard, python3-websocket")
set(CPACK_DEBIAN_HOST_PACKAGE_SUGGESTS "python3-lz4, python3-matplotlib")
set(CPACK_DEBIAN_HOST_PACKAGE_CONTROL_EXTRA ${packaging}/host/postinst ${packaging}/host/prerm)
set(CPACK_DEBIAN_HOST_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_HOST_DESCRIPTION "simulator, monitor and recorder of a walking robot, for the host
Simulated robot, gait synthesis, experiments, live page, records and their
replay, for the controller stiltd.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libstilt-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "liburdfdom-dev, libconsole-bridge-dev, libtinyxml2-dev, libtomlplusplus-dev")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS libmujoco-dev)
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "controller of a walking robot as a library
Planner, estimator, torque law and supervisor of stiltd for loops of one's own,
and the simulated robot: static libraries, headers, CMake and pkg-config files,
an example.")
file(WRITE ${made}/conffiles "/etc/stilt/stiltd.toml\n")
include(CPack)
