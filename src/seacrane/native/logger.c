/* The logger callback of FMI 1.0 and 2.0 takes a printf format with its arguments, which only C can put together. */
#include <stdarg.h>
#include <stdio.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef void (*receiver_t)(void *, const char *, int, const char *, const char *);
static receiver_t receiver;

/* Who gets the messages of all FMUs of this process. */
EXPORT void seacrane_logger_receiver(receiver_t given) { receiver = given; }

/* `environment` is the component itself in FMI 1.0; it is only passed on, as the name of whom the message is from. */
EXPORT void seacrane_logger(void *environment, const char *instance, int status, const char *category,
                            const char *format, ...)
{
    char text[8192];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format ? format : "", arguments);
    va_end(arguments);
    if (receiver)
        receiver(environment, instance, status, category, text);
}
