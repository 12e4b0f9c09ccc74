/* Runs the library of an FMU where it belongs and prints what it gives, bit by bit. LIBRARY, GUID, INPUT (a value
   reference), OUTPUTS (value references) and STEPS are set on the compiler's command line. Nothing but the loader of the
   system is used, so that a program for Windows needs no C library. */
#include <stdint.h>

#ifdef _WIN32
__declspec(dllimport) void *LoadLibraryA(const char *name);
__declspec(dllimport) void *GetProcAddress(void *library, const char *name);
__declspec(dllimport) void *GetStdHandle(unsigned which);
__declspec(dllimport) int WriteFile(void *file, const void *text, unsigned size, unsigned *written, void *overlapped);
__declspec(dllimport) void ExitProcess(unsigned status);
int _fltused = 0;

static void print(const char *text, unsigned size)
{
    unsigned written;
    WriteFile(GetStdHandle(-11), text, size, &written, 0);
}
#else
#include <dlfcn.h>
#include <unistd.h>
#define LoadLibraryA(name) dlopen(name, RTLD_NOW)
#define GetProcAddress dlsym

static void print(const char *text, unsigned size)
{
    if (write(1, text, size) < 0)
        _exit(9);
}
#endif

struct callbacks {
    void (*logger)(void *environment, const char *name, int status, const char *category, const char *message, ...);
    void *(*allocate)(uintptr_t count, uintptr_t size);
    void (*release)(void *memory);
    void (*finished)(void *environment, int status);
    void *environment;
};

static void print_line(const char *text)
{
    unsigned size = 0;
    while (text[size] != 0)
        size++;
    print(text, size);
    print("\n", 1);
}

static void logger(void *environment, const char *name, int status, const char *category, const char *message, ...)
{
    (void)environment, (void)name, (void)status, (void)category;
    print_line(message);
}

static void print_bits(double value)
{
    union {
        double value;
        uint64_t bits;
    } both = {value};
    char text[17];
    for (int i = 0; i < 16; i++)
        text[i] = "0123456789abcdef"[both.bits >> (60 - 4 * i) & 15];
    text[16] = ' ';
    print(text, 17);
}

static int run(void)
{
    static const uint32_t input = INPUT, outputs[] = {OUTPUTS};
    enum { COUNT = sizeof outputs / sizeof *outputs };
    static double value[COUNT], spool = 0.7, wrong = 1e999;
    static const struct callbacks callbacks = {logger};
    void *library = LoadLibraryA(LIBRARY);
    if (library == 0)
        return 1;
    void *(*instantiate)(const char *, int, const char *, const char *, const struct callbacks *, int, int) =
        GetProcAddress(library, "fmi2Instantiate");
    int (*set_up)(void *, int, double, double, int, double) = GetProcAddress(library, "fmi2SetupExperiment");
    int (*enter)(void *) = GetProcAddress(library, "fmi2EnterInitializationMode");
    int (*leave)(void *) = GetProcAddress(library, "fmi2ExitInitializationMode");
    int (*set)(void *, const uint32_t *, uintptr_t, const double *) = GetProcAddress(library, "fmi2SetReal");
    int (*get)(void *, const uint32_t *, uintptr_t, double *) = GetProcAddress(library, "fmi2GetReal");
    int (*step)(void *, double, double, int) = GetProcAddress(library, "fmi2DoStep");
    void (*release)(void *) = GetProcAddress(library, "fmi2FreeInstance");
    void *m = instantiate("drive", 1, GUID, "", &callbacks, 0, 0);
    if (m == 0 || set_up(m, 0, 0, 0, 0, 0) != 0 || enter(m) != 0 || leave(m) != 0)
        return 2;
    if (set(m, &input, 1, &wrong) == 0 || step(m, 0.0625, 0.25, 1) == 0 || set(m, &input, 1, &spool) != 0)
        return 3;
    for (int i = 0; i < STEPS; i++) {
        if (step(m, i * 0.01, 0.01, 1) != 0 || get(m, outputs, COUNT, value) != 0)
            return 4;
        for (int j = 0; j < COUNT; j++)
            print_bits(value[j]);
        print("\n", 1);
    }
    release(m);
    return 0;
}

#ifdef _WIN32
void mainCRTStartup(void)
{
    ExitProcess((unsigned)run());
}
#else
int main(void)
{
    return run();
}
#endif
