#include "gl/context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fcntl.h>
#include <gbm.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"
#include "base/log.h"

#define DEVICES_MAX 32

/* One way to get a display, and what became of it. */
struct attempt {
    struct device_info info;
    EGLDeviceEXT device; /* platform "device" */
};

static const char *egl_error_name(void)
{
    switch (eglGetError()) {
    case EGL_SUCCESS: return "no reason given";
    case EGL_NOT_INITIALIZED: return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ACCESS: return "EGL_BAD_ACCESS";
    case EGL_BAD_ALLOC: return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE: return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG: return "EGL_BAD_CONFIG";
    case EGL_BAD_DISPLAY: return "EGL_BAD_DISPLAY";
    case EGL_BAD_MATCH: return "EGL_BAD_MATCH";
    case EGL_BAD_PARAMETER: return "EGL_BAD_PARAMETER";
    default: return "an EGL error";
    }
}

static bool has_word(const char *list, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = list; at && (at = strstr(at, word)); at += length)
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == 0))
            return true;
    return false;
}

static bool client_has(const char *extension) { return has_word(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), extension); }

static void describe_egl_device(struct attempt *a)
{
    const char *extensions = eglQueryDeviceStringEXT(a->device, EGL_EXTENSIONS);
    a->info.software = has_word(extensions, "EGL_MESA_device_software");
    if (has_word(extensions, "EGL_EXT_device_drm")) {
        const char *node = eglQueryDeviceStringEXT(a->device, EGL_DRM_DEVICE_FILE_EXT);
        snprintf(a->info.node, sizeof a->info.node, "%s", node ? node : "");
    }
    EGLAttrib cuda;
    if (has_word(extensions, "EGL_NV_device_cuda") && eglQueryDeviceAttribEXT(a->device, EGL_CUDA_DEVICE_NV, &cuda))
        a->info.cuda = (int)cuda;
}

/* Every way in, in the order in which they are tried. */
static size_t collect_attempts(struct attempt *out)
{
    size_t n = 0;
    EGLDeviceEXT devices[DEVICES_MAX];
    EGLint count = 0;
    if (client_has("EGL_EXT_device_enumeration") && client_has("EGL_EXT_platform_device") &&
        eglQueryDevicesEXT(DEVICES_MAX, devices, &count))
        for (EGLint i = 0; i < count; i++) {
            out[n] = (struct attempt){.info = {.index = i, .platform = "device", .cuda = -1}, .device = devices[i]};
            describe_egl_device(&out[n++]);
        }
    out[n++] = (struct attempt){.info = {.index = -1, .platform = "surfaceless", .cuda = -1}};
    out[n++] = (struct attempt){.info = {.index = -1, .platform = "gbm", .cuda = -1}};
    return n;
}

/* libepoxy resolves eglGetPlatformDisplay only once a display exists: the EXT entry point works before. */
static EGLDisplay open_display(struct gl_context *gl, struct attempt *a)
{
    char *why = a->info.why_not;
    size_t size = sizeof a->info.why_not;
    if (strcmp(a->info.platform, "device") == 0)
        return eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, a->device, NULL);
    if (strcmp(a->info.platform, "surfaceless") == 0) {
        if (client_has("EGL_MESA_platform_surfaceless"))
            return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
        snprintf(why, size, "EGL_MESA_platform_surfaceless is not offered");
        return EGL_NO_DISPLAY;
    }
    if (!client_has("EGL_KHR_platform_gbm") && !client_has("EGL_MESA_platform_gbm")) {
        snprintf(why, size, "EGL_KHR_platform_gbm is not offered");
        return EGL_NO_DISPLAY;
    }
    snprintf(a->info.node, sizeof a->info.node, "/dev/dri/renderD128");
    gl->gbm_fd = open(a->info.node, O_RDWR | O_CLOEXEC);
    gl->gbm = gl->gbm_fd >= 0 ? gbm_create_device(gl->gbm_fd) : NULL;
    if (gl->gbm)
        return eglGetPlatformDisplayEXT(EGL_PLATFORM_GBM_KHR, gl->gbm, NULL);
    snprintf(why, size, "%s cannot be opened", a->info.node);
    return EGL_NO_DISPLAY;
}

static void close_context(struct gl_context *gl)
{
    if (gl->display) {
        eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (gl->context)
            eglDestroyContext(gl->display, gl->context);
        eglTerminate(gl->display);
    }
    if (gl->gbm)
        gbm_device_destroy(gl->gbm);
    if (gl->gbm_fd >= 0)
        close(gl->gbm_fd);
    gl->display = gl->context = gl->gbm = NULL;
    gl->gbm_fd = -1;
}

/* With word of resets (a driver that hung, a device that went away) where the driver gives it. */
static EGLContext create_context(EGLDisplay display, EGLConfig config, bool debug)
{
    EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                           4,
                           EGL_CONTEXT_MINOR_VERSION,
                           5,
                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                           EGL_CONTEXT_OPENGL_DEBUG,
                           debug,
                           EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                           EGL_LOSE_CONTEXT_ON_RESET,
                           EGL_NONE};
    EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
    if (context)
        return context;
    attributes[8] = EGL_NONE;
    return eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
}

static bool make_context(struct gl_context *gl, struct attempt *a, bool debug)
{
    char *why = a->info.why_not;
    size_t size = sizeof a->info.why_not;
    gl->display = open_display(gl, a);
    if (!gl->display) {
        if (!why[0])
            snprintf(why, size, "no display: %s", egl_error_name());
        return false;
    }
    EGLint major, minor;
    if (!eglInitialize(gl->display, &major, &minor)) {
        snprintf(why, size, "eglInitialize: %s", egl_error_name());
        gl->display = NULL;
        return false;
    }
    const char *extensions = eglQueryString(gl->display, EGL_EXTENSIONS);
    if (!has_word(extensions, "EGL_KHR_surfaceless_context")) {
        snprintf(why, size, "EGL_KHR_surfaceless_context is not offered");
        return false;
    }
    eglBindAPI(EGL_OPENGL_API);
    EGLConfig config = EGL_NO_CONFIG_KHR;
    if (!has_word(extensions, "EGL_KHR_no_config_context")) {
        EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE}, count = 0;
        if (!eglChooseConfig(gl->display, wanted, &config, 1, &count) || count == 0) {
            snprintf(why, size, "no configuration for OpenGL");
            return false;
        }
    }
    gl->context = create_context(gl->display, config, debug);
    if (!gl->context || !eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, gl->context)) {
        snprintf(why, size, "no OpenGL 4.5 core context: %s", egl_error_name());
        return false;
    }
    return true;
}

static void read_strings(struct device_info *info)
{
    snprintf(info->vendor, sizeof info->vendor, "%s", (const char *)glGetString(GL_VENDOR));
    snprintf(info->renderer, sizeof info->renderer, "%s", (const char *)glGetString(GL_RENDERER));
    snprintf(info->version, sizeof info->version, "%s", (const char *)glGetString(GL_VERSION));
    if (strstr(info->renderer, "llvmpipe") || strstr(info->renderer, "softpipe"))
        info->software = true;
}

static void read_caps(struct gl_context *gl)
{
    GLint value;
    GLint64 wide;
    gl->caps.software = gl->device.software;
    gl->caps.conservative_raster =
        epoxy_has_gl_extension("GL_NV_conservative_raster") || epoxy_has_gl_extension("GL_INTEL_conservative_rasterization");
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &gl->caps.max_texture_size);
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &value);
    gl->caps.max_texture_buffer = value;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &wide);
    gl->caps.max_storage_block = (long)wide;
    snprintf(gl->cache_key, sizeof gl->cache_key, "%s|%s|%s", gl->device.vendor, gl->device.renderer, gl->device.version);
}

static void GLAPIENTRY on_debug(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length, const GLchar *text,
                                const void *user)
{
    (void)source, (void)id, (void)length, (void)user;
    if (severity == GL_DEBUG_SEVERITY_NOTIFICATION)
        return;
    log_write(type == GL_DEBUG_TYPE_ERROR ? LOG_ERROR : LOG_DEBUG, "gl: %s", text);
}

static void set_initial_state(bool debug)
{
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glDisable(GL_DITHER);
    if (debug) {
        glEnable(GL_DEBUG_OUTPUT);
        glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        glDebugMessageCallback(on_debug, NULL);
    }
}

static bool is_number(const char *text) { return text[0] && strspn(text, "0123456789") == strlen(text); }

static bool wanted(const struct device_info *info, const char *device)
{
    if (!device)
        return true;
    if (strcmp(device, "software") == 0)
        return info->software || strcmp(info->platform, "surfaceless") == 0;
    if (strncmp(device, "cuda:", 5) == 0)
        return info->cuda >= 0 && is_number(device + 5) && atoi(device + 5) == info->cuda;
    if (is_number(device))
        return info->index == atoi(device);
    return strcmp(info->node, device) == 0 || (device[0] == '/' && strcmp(info->platform, "gbm") == 0 && !info->node[0]);
}

/* Mesa reads these when the screen is made. */
static void prepare_environment(const struct gl_context_options *options)
{
    if (options->threads) {
        char text[16];
        snprintf(text, sizeof text, "%u", options->threads);
        setenv("LP_NUM_THREADS", text, 0);
    }
    if (options->device && strcmp(options->device, "software") == 0)
        setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
}

bool gl_context_init(struct gl_context *gl, const struct gl_context_options *options, struct error *err)
{
    memset(gl, 0, sizeof *gl);
    gl->gbm_fd = -1;
    prepare_environment(options);
    struct attempt attempts[DEVICES_MAX + 2];
    size_t count = collect_attempts(attempts), tried = 0;
    char story[400] = "";
    for (size_t i = 0; i < count; i++) {
        struct attempt *a = &attempts[i];
        if (!wanted(&a->info, options->device))
            continue;
        tried++;
        if (make_context(gl, a, options->debug)) {
            gl->device = a->info;
            read_strings(&gl->device);
            read_caps(gl);
            set_initial_state(options->debug);
            log_info("gl: %s, %s (platform %s)", gl->device.renderer, gl->device.version, gl->device.platform);
            return true;
        }
        close_context(gl);
        size_t used = strlen(story);
        snprintf(story + used, sizeof story - used, "%s%s %d: %s", used ? "; " : "", a->info.platform, a->info.index,
                 a->info.why_not);
        log_info("gl: platform %s %d: %s", a->info.platform, a->info.index, a->info.why_not);
    }
    if (!tried)
        return error_set(err, ERROR_NO_DEVICE, "device",
                         "no device '%s': give an index of `gnomon list devices`, a DRM node, cuda:N or software",
                         options->device);
    return error_set(err, ERROR_NO_DEVICE, "device",
                     "no device gives an OpenGL 4.5 core context (%s); `gnomon list devices` prints those that do", story);
}

void gl_context_finish(struct gl_context *gl) { close_context(gl); }

bool gl_check_at(struct gl_context *gl, const char *where, struct error *err)
{
    GLenum code = glGetGraphicsResetStatus() == GL_NO_ERROR ? glGetError() : GL_CONTEXT_LOST;
    if (code == GL_NO_ERROR)
        return true;
    gl->failed = true;
    /* A lost context may answer for ever. */
    for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; i++)
        ;
    log_warning("%s: GL error 0x%04x", where, code);
    if (code == GL_OUT_OF_MEMORY)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "the GL device is out of memory (%s): use a smaller size", where);
    if (code == GL_CONTEXT_LOST)
        return error_set(err, ERROR_TRY_AGAIN, NULL, "the GL device was lost (%s): try again", where);
    return error_set(err, ERROR_BUG, NULL, "GL error 0x%04x in %s", code, where);
}

size_t gl_device_list(struct device_info *out, size_t max)
{
    struct attempt attempts[DEVICES_MAX + 2];
    size_t count = collect_attempts(attempts), n = 0;
    for (size_t i = 0; i < count && n < max; i++) {
        struct gl_context gl = {.gbm_fd = -1};
        if (make_context(&gl, &attempts[i], false))
            read_strings(&attempts[i].info);
        close_context(&gl);
        out[n++] = attempts[i].info;
    }
    return n;
}
