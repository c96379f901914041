# Writes the source of firmware/version/commit.h when it has changed:
#
#   cmake -DROOT=FOLDER -DOUTPUT=FILE -P commit.cmake
#
# ROOT must be the root of the repository: sources unpacked inside another repository have no commit. They are
# "unknown-" and a hash of the product's files, so that folders of results tell two of them apart. Changed
# documents and tests do not make a program dirty, because they are not part of it. The comment in the source is for
# package_version.cmake. Its number grows with each commit: the package of a newer commit has a newer version. Behind
# "dirty" stands when the newest changed file was written, in UTC: later changes have a newer version, too.
set(commit unknown)
set(in_version "")
find_program(GIT git)
if(GIT AND EXISTS ${ROOT}/.git)
  execute_process(COMMAND ${GIT} rev-parse --short=12 HEAD
    WORKING_DIRECTORY ${ROOT} RESULT_VARIABLE no_head OUTPUT_VARIABLE head ERROR_QUIET
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  execute_process(COMMAND ${GIT} status --porcelain -- . :!docs :!tests
    WORKING_DIRECTORY ${ROOT} RESULT_VARIABLE no_status OUTPUT_VARIABLE changes ERROR_QUIET)
  execute_process(COMMAND ${GIT} rev-list --count HEAD
    WORKING_DIRECTORY ${ROOT} OUTPUT_VARIABLE number ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(no_head EQUAL 0 AND no_status EQUAL 0)
    set(commit ${head})
    set(in_version +git${number}.${head})
    if(changes)
      execute_process(COMMAND ${GIT} ls-files --modified --deleted --others --exclude-standard -- . :!docs :!tests
        WORKING_DIRECTORY ${ROOT} OUTPUT_VARIABLE files ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
      execute_process(COMMAND ${GIT} diff --cached --name-only -- . :!docs :!tests
        WORKING_DIRECTORY ${ROOT} OUTPUT_VARIABLE staged ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
      string(REPLACE "\n" ";" files "${files}\n${staged}")
      set(newest 0)
      foreach(file IN LISTS files)
        set(written 0)
        if(file AND EXISTS ${ROOT}/${file})
          file(TIMESTAMP ${ROOT}/${file} written %Y%m%dT%H%M%SZ UTC)
        elseif(file)
          get_filename_component(folder ${ROOT}/${file} DIRECTORY)  # a file that is gone changed its folder
          while(NOT EXISTS ${folder})
            get_filename_component(folder ${folder} DIRECTORY)
          endwhile()
          file(TIMESTAMP ${folder} written %Y%m%dT%H%M%SZ UTC)
        endif()
        if(written STRGREATER newest)
          set(newest ${written})
        endif()
      endforeach()
      string(APPEND commit -dirty.${newest})
      string(APPEND in_version .dirty.${newest})
    endif()
  endif()
endif()

if(commit STREQUAL unknown)
  set(product firmware mpc_core hal codegen host_tools toolchain/cmake)
  list(TRANSFORM product PREPEND ${ROOT}/)
  list(TRANSFORM product APPEND /*)
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${product})
  list(FILTER files EXCLUDE REGEX "/node_modules/")
  list(SORT files)
  set(hashes "")
  foreach(file IN LISTS files)
    file(SHA256 ${ROOT}/${file} hash)
    string(APPEND hashes "${hash} ${file}\n")
  endforeach()
  string(SHA256 hash "${hashes}")
  string(SUBSTRING ${hash} 0 12 hash)
  set(commit unknown-${hash})
endif()

set(source "#include \"firmware/version/commit.h\"

namespace stilt::version {

// In the version of a package: ${in_version}
std::string_view commit() noexcept { return \"${commit}\"; }

}  // namespace stilt::version
")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} present)
endif()
if(NOT source STREQUAL "${present}")
  file(WRITE ${OUTPUT} "${source}")
endif()
