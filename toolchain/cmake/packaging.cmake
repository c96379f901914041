# Debian packages (toolchain/package): stiltd for the robot's computer, stilt for the host
# (docs/decisions/0012-packages.md).
include(GNUInstallDirs)
set(packaging ${PROJECT_SOURCE_DIR}/toolchain/packaging)

install(TARGETS stiltd DESTINATION bin COMPONENT robot)
install(FILES firmware/configuration/amber3m.toml DESTINATION /etc/stilt RENAME stiltd.toml COMPONENT robot)
install(FILES ${packaging}/stiltd.service DESTINATION lib/systemd/system COMPONENT robot)
install(FILES ${packaging}/stilt.sysusers DESTINATION lib/sysusers.d RENAME stilt.conf COMPONENT robot)
install(FILES ${packaging}/80-can0.network ${packaging}/80-can.rules
  codegen/robots/amber3m.urdf codegen/robots/rabbit.urdf firmware/configuration/rabbit.toml
  DESTINATION share/doc/stiltd/examples COMPONENT robot)
install(FILES docs/deployment.md docs/security.md LICENSE DESTINATION share/doc/stiltd COMPONENT robot)

install(TARGETS stilt DESTINATION bin COMPONENT host)
install(DIRECTORY docs DESTINATION share/doc/stilt COMPONENT host PATTERN *.py EXCLUDE)
install(FILES README.md LICENSE DESTINATION share/doc/stilt COMPONENT host)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR Stilt)
set(CPACK_PACKAGE_CONTACT "Stilt")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL robot host)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_ROBOT_PACKAGE_NAME stiltd)
set(CPACK_COMPONENT_ROBOT_DESCRIPTION
  "stiltd, for the robot's computer: whole-body model predictive control and torque loop over CAN.")
set(CPACK_DEBIAN_ROBOT_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/packaging/conffiles ${packaging}/postinst)
set(CPACK_DEBIAN_ROBOT_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_HOST_PACKAGE_NAME stilt)
set(CPACK_COMPONENT_HOST_DESCRIPTION
  "stilt, for the host: simulator, gait synthesis, experiments, monitor, recorder.")
file(WRITE ${PROJECT_BINARY_DIR}/packaging/conffiles "/etc/stilt/stiltd.toml\n")
include(CPack)
