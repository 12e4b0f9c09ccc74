/* What a WebAssembly module needs besides the model: formatted text for messages. The printf of a C library would be a
   third of the module, most of it for long double; this knows %s %d %u %% and %g, the last to 15 digits at most. */
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

struct text {
    char *at;
    size_t room; /* without the final zero */
};

static void put(struct text *t, char c)
{
    if (t->room > 0) {
        *t->at++ = c;
        t->room--;
    }
}

static void put_text(struct text *t, const char *s)
{
    while (*s != '\0')
        put(t, *s++);
}

static void put_natural(struct text *t, uint32_t n)
{
    if (n >= 10)
        put_natural(t, n / 10);
    put(t, (char)('0' + n % 10));
}

static double power_of_ten(int n)
{
    double result = 1, base = 10;
    for (; n > 0; n /= 2, base *= base)
        if (n % 2)
            result *= base;
    return result;
}

/* |v| is m * 10^(e - digits + 1) with a whole m of as many digits; returns m. */
static uint64_t decimal(double v, int digits, int *e)
{
    int n = 0;
    while (n < 300 && v >= power_of_ten(n + 1))
        n++;
    while (n > -290 && v * power_of_ten(-n) < 1) /* n <= 0 here */
        n--;
    int shift = digits - 1 - n;
    double m = floor((shift >= 0 ? v * power_of_ten(shift) : v / power_of_ten(-shift)) + 0.5);
    int rounded_up = m >= power_of_ten(digits);
    *e = n + rounded_up;
    return (uint64_t)(rounded_up ? m / 10 : m);
}

static void put_real(struct text *t, double v, int digits)
{
    char digit[15];
    int e, last = 0;
    if (signbit(v))
        put(t, '-');
    if (!isfinite(v) || v == 0) {
        put_text(t, isnan(v) ? "nan" : v == 0 ? "0" : "inf");
        return;
    }
    uint64_t m = decimal(fabs(v), digits, &e);
    for (int i = digits - 1; i >= 0; i--, m /= 10) {
        digit[i] = (char)('0' + m % 10);
        if (last == 0 && m % 10 != 0)
            last = i; /* zeros at the end are left out */
    }
    int scientific = e < -4 || e >= digits, point = scientific ? 0 : e; /* the decimal point follows this digit */
    for (int i = point < 0 ? point : 0; i <= last || i <= point; i++) { /* zeros before the first digit are i < 0 */
        put(t, i < 0 ? '0' : digit[i]);
        if (i == point && last > point)
            put(t, '.');
    }
    if (scientific) {
        put(t, 'e');
        put(t, e < 0 ? '-' : '+');
        if (e > -10 && e < 10)
            put(t, '0');
        put_natural(t, (uint32_t)(e < 0 ? -e : e));
    }
}

/* vsnprintf of this module, by a macro on the compiler's command line. */
int seacrane_format(char *text, size_t size, const char *format, va_list arguments)
{
    struct text t = {text, size - 1};
    for (const char *c = format; *c != '\0'; c++) {
        int digits = 0;
        if (*c != '%') {
            put(&t, *c);
            continue;
        }
        if (*++c == '.')
            while (*++c >= '0' && *c <= '9')
                digits = 10 * digits + *c - '0';
        int whole;
        switch (*c) {
        case 's':
            put_text(&t, va_arg(arguments, const char *));
            break;
        case 'd':
            whole = va_arg(arguments, int);
            if (whole < 0)
                put(&t, '-');
            put_natural(&t, whole < 0 ? 0u - (uint32_t)whole : (uint32_t)whole);
            break;
        case 'u':
            put_natural(&t, va_arg(arguments, uint32_t));
            break;
        case 'g':
            put_real(&t, va_arg(arguments, double), digits > 0 ? digits : 6);
            break;
        default:
            put(&t, *c);
        }
    }
    *t.at = '\0';
    return (int)(t.at - text);
}
