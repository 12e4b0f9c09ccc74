/* What a Windows DLL needs besides the model when it is linked to the system's C library (ucrtbase.dll, part of Windows
   10) and to nothing else: an entry point, formatted text, and the probe of large stack frames. */
#include <stdarg.h>
#include <stddef.h>

int _fltused = 0; /* the linker's mark for code with floating point */

int DllMainCRTStartup(void *module, unsigned reason, void *reserved)
{
    (void)module, (void)reason, (void)reserved;
    return 1;
}

int __stdio_common_vsprintf(unsigned long long options, char *text, size_t size, const char *format, void *locale,
                            va_list arguments);

/* As in C99: always terminated. Option 2 of the system's function asks for that. */
int vsnprintf(char *text, size_t size, const char *format, va_list arguments)
{
    return __stdio_common_vsprintf(2, text, size, format, NULL, arguments);
}

/* Called before a frame of rax bytes is made: touches each page of it in turn, so that the system extends the stack.
   All registers are kept. */
__asm__(".globl ___chkstk_ms\n"
        "___chkstk_ms:\n"
        "    pushq %rax\n"
        "    pushq %rcx\n"
        "    leaq 24(%rsp), %rcx\n"
        "1:  cmpq $4096, %rax\n"
        "    jb 2f\n"
        "    subq $4096, %rcx\n"
        "    orq $0, (%rcx)\n"
        "    subq $4096, %rax\n"
        "    jmp 1b\n"
        "2:  subq %rax, %rcx\n"
        "    orq $0, (%rcx)\n"
        "    popq %rcx\n"
        "    popq %rax\n"
        "    ret\n");
