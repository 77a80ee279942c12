# Reads the sources given (paths relative to the tree's root) and prints "FILE:LINE: what is wrong" for every include or word that breaks
# the layers. -v allowed=FILE (allowed.txt), -v headers=LIST of the tree's headers, -v algorithms=LIST of names, space separated.
# Plain awk: mawk has no \b and no 3-argument match().

function folder_of(path,    part, n) {
    n = split(path, part, "/")
    if (part[1] == "renderer")
        return n > 2 ? part[2] : "top"
    return part[1]
}

# The folder that `#include "name"` in `path` means; "" when no header of the tree has that name (one made by the build).
function included_folder(name, path,    own) {
    own = path
    sub(/[^\/]*$/, "", own)
    if ((own name) in header) return folder_of(own name)
    if (("renderer/" name) in header) return folder_of("renderer/" name)
    if (("server/" name) in header) return "server"
    if (("shaders/" name) in header) return "shaders"
    if (("proto/" name) in header || name ~ /^proto\//) return "proto"
    return ""
}

function complain(text) {
    printf "%s:%d: %s\n", FILENAME, FNR, text
}

# only(PATTERN, FOLDERS, WHAT): the system header `name` may be included from FOLDERS alone.
function only(pattern, folders, what) {
    if (name ~ pattern && folders !~ (" " folder " ") && folders !~ (" " FILENAME " "))
        complain("<" name "> belongs to" folders "(" what ")")
}

BEGIN {
    while ((getline line < allowed) > 0) {
        if (line ~ /^#/ || line !~ /[^ ]/)
            continue
        n = split(line, word, " ")
        known[word[1]] = 1
        for (i = 2; i <= n; i++)
            may[word[1], word[i]] = 1
    }
    n = split(headers, word, " ")
    for (i = 1; i <= n; i++)
        header[word[i]] = 1
    algorithm_count = split(algorithms, algorithm, " ")
}

FNR == 1 {
    folder = folder_of(FILENAME)
    if (!(folder in known))
        complain("folder '" folder "' is not in tests/layers/allowed.txt")
    if (FILENAME ~ /\.(cc|cpp|cxx|hpp|hh)$/ && folder != "import")
        complain("C++ belongs to renderer/import")
}

/^[ \t]*#[ \t]*include[ \t]*"/ {
    name = $0
    sub(/^[^"]*"/, "", name)
    sub(/".*/, "", name)
    to = included_folder(name, FILENAME)
    if (to == "" && folder != "server")
        complain("\"" name "\" is no header of the tree")
    else if (name == "net_state.h" && FILENAME !~ /^server\/net(_[a-z]+)?\.c$/)
        complain("\"net_state.h\" is for server/net.c and net_*.c alone")
    else if (to != "" && !((folder, to) in may))
        complain(folder " includes \"" name "\": " to " is not below it")
}

/^[ \t]*#[ \t]*include[ \t]*</ {
    name = $0
    sub(/^[^<]*</, "", name)
    sub(/>.*/, "", name)
    only("^libwebsockets", " server/net_state.h ", "the network thread: net*.c include net_state.h")
    # The renderer's front joins the parts: it binds their buffers, nothing more.
    only("^epoxy/gl\\.h$", " gl draw passes shadow renderer/renderer.c renderer/frame.c renderer/reading.c ", "GL")
    only("^(epoxy/egl|GL/|GLES[23]?/|EGL/|KHR/)", " gl ", "GL")
    only("^(gbm|xf86drm)\\.h$", " gl ", "GL")
    only("^embree", " trace reference ", "ray tracing")
    only("^gmp", " reference ", "exact arithmetic")
    only("^(OpenImageIO/|tiny_gltf|nlohmann/)", " import ", "files")
    only("^curl/", " server/remote.c ", "HTTP to another server")
    only("^(turbojpeg|jansson|libav)", " server ", "clients")
    only("^(sys/socket|netinet/|arpa/|netdb)", " server ", "the renderer has no sockets")
}

# The suites of the bench are tables of names; what is not registered is left out of a run.
folder != "shadow" && FILENAME !~ /^server\/bench\/suites\// {
    for (i = 1; i <= algorithm_count; i++)
        if (index($0, "\"" algorithm[i] "\"") || index($0, "\"" algorithm[i] ":"))
            complain("names the shadow system '" algorithm[i] "': only renderer/shadow knows which there are")
}

/(pthread_create|thrd_create|std::(thread|async|jthread)) *[({ ]/ && folder != "base" && folder != "server" {
    complain("starts a thread: the renderer has none but those of the job pool that it is given")
}

/"#version|gl_Position|gl_FragCoord/ && folder != "gl" {
    complain("a shader in a string: shaders are files in shaders/")
}
