/* A slave of FMI 3 as somebody else would write it, against the headers of the standard: it passes inputs of all types on
   to outputs, and y = A u with arrays sized by structural parameters. It counts how often an Int8 is set. */
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"

enum { ROWS = 2, COLUMNS = 3, VR_N = 1, VR_M, VR_A, VR_U, VR_Y, VR_REAL, VR_ENUMERATION = 20, VR_OUT = 30, VR_SETS = 60 };
typedef struct {
    double a[ROWS * COLUMNS], u[COLUMNS], real;
    fmi3Float32 f32; fmi3Int8 i8; fmi3UInt8 u8; fmi3Int16 i16; fmi3UInt16 u16; fmi3Int32 i32; fmi3UInt32 u32;
    fmi3Int64 i64[2]; fmi3UInt64 u64; fmi3Boolean boolean;
    unsigned sets;
    char label[16];
    fmi3Byte blob[4];
    size_t blob_size;
} Slave;

const char *fmi3GetVersion(void) { return fmi3Version; }
fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String s[])
{ (void)c, (void)on, (void)n, (void)s; return fmi3OK; }
fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference required[], size_t n, fmi3InstanceEnvironment e,
                                         fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)required;
    (void)n, (void)e, (void)log, (void)update;
    Slave *s = calloc(1, sizeof *s);
    for (int i = 0; i < ROWS * COLUMNS; i++) s->a[i] = i + 1;
    s->i64[1] = 1;
    return s;
}
void fmi3FreeInstance(fmi3Instance c) { free(c); }
fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean a, fmi3Float64 b, fmi3Float64 t, fmi3Boolean d, fmi3Float64 e)
{ (void)c, (void)a, (void)b, (void)t, (void)d, (void)e; return fmi3OK; }
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3Terminate(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3Reset(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean n, fmi3Boolean *event, fmi3Boolean *end,
                      fmi3Boolean *early, fmi3Float64 *last)
{ (void)c, (void)n; *event = *end = *early = fmi3False; *last = t + h; return fmi3OK; }

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 v[], size_t m)
{
    const Slave *s = c;
    size_t j = 0;
    for (size_t i = 0; i < n; i++)
        if (r[i] == VR_A) memcpy(v + j, s->a, sizeof s->a), j += ROWS * COLUMNS;
        else if (r[i] == VR_U) memcpy(v + j, s->u, sizeof s->u), j += COLUMNS;
        else if (r[i] == VR_Y)
            for (int row = 0; row < ROWS; row++, j++) {
                v[j] = 0;
                for (int k = 0; k < COLUMNS; k++) v[j] += s->a[row * COLUMNS + k] * s->u[k];
            }
        else v[j++] = s->real;
    return j == m ? fmi3OK : fmi3Error;
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 v[], size_t m)
{
    Slave *s = c;
    size_t j = 0;
    for (size_t i = 0; i < n; i++)
        if (r[i] == VR_A) memcpy(s->a, v + j, sizeof s->a), j += ROWS * COLUMNS;
        else if (r[i] == VR_U) memcpy(s->u, v + j, sizeof s->u), j += COLUMNS;
        else if (r[i] == VR_REAL) s->real = v[j++];
        else return fmi3Error;
    return j == m ? fmi3OK : fmi3Error;
}
#define ACCESS(name, type, field, more) \
    fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference r[], size_t n, type v[], size_t m) \
    { const Slave *s = c; (void)r; for (size_t i = 0; i < n; i++) v[i] = (type)(field); return n == m ? fmi3OK : fmi3Error; } \
    fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference r[], size_t n, const type v[], size_t m) \
    { Slave *s = c; for (size_t i = 0; i < n; i++) { if (r[i] >= VR_OUT) return fmi3Error; more; field = v[i]; } \
      return n == m ? fmi3OK : fmi3Error; }
ACCESS(Float32, fmi3Float32, s->f32, )
ACCESS(Int8, fmi3Int8, s->i8, s->sets++)
ACCESS(UInt8, fmi3UInt8, s->u8, )
ACCESS(Int16, fmi3Int16, s->i16, )
ACCESS(UInt16, fmi3UInt16, s->u16, )
ACCESS(Int32, fmi3Int32, s->i32, )
ACCESS(Int64, fmi3Int64, s->i64[r[i] % VR_OUT == VR_ENUMERATION], )
ACCESS(UInt64, fmi3UInt64, s->u64, )
ACCESS(Boolean, fmi3Boolean, s->boolean, )
fmi3Status fmi3GetUInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3UInt32 v[], size_t m)
{ const Slave *s = c; for (size_t i = 0; i < n; i++) v[i] = r[i] == VR_SETS ? s->sets : s->u32; return n == m ? fmi3OK : fmi3Error; }
fmi3Status fmi3SetUInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3UInt32 v[], size_t m)
{ (void)r; for (size_t i = 0; i < n; i++) ((Slave *)c)->u32 = v[i]; return n == m ? fmi3OK : fmi3Error; }
fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3String v[], size_t m)
{ (void)r, (void)m; for (size_t i = 0; i < n; i++) v[i] = ((Slave *)c)->label; return fmi3OK; }
fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3String v[], size_t m)
{ (void)r, (void)m; for (size_t i = 0; i < n; i++) strncpy(((Slave *)c)->label, v[i], 15); return fmi3OK; }
fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, size_t z[], fmi3Binary v[], size_t m)
{ (void)r, (void)m; for (size_t i = 0; i < n; i++) v[i] = ((Slave *)c)->blob, z[i] = ((Slave *)c)->blob_size; return fmi3OK; }
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, const size_t z[], const fmi3Binary v[], size_t m)
{ (void)r, (void)m; Slave *s = c; for (size_t i = 0; i < n; i++) memcpy(s->blob, v[i], s->blob_size = z[i] < 4 ? z[i] : 4); return fmi3OK; }

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *s) { *s = malloc(sizeof(Slave)); memcpy(*s, c, sizeof(Slave)); return fmi3OK; }
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState s) { memcpy(c, s, sizeof(Slave)); return fmi3OK; }
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *s) { (void)c; free(*s); *s = NULL; return fmi3OK; }
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState s, size_t *n) { (void)c, (void)s; *n = sizeof(Slave); return fmi3OK; }
fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState s, fmi3Byte b[], size_t n) { (void)c; memcpy(b, s, n); return fmi3OK; }
fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte b[], size_t n, fmi3FMUState *s)
{ (void)c; if (n != sizeof(Slave)) return fmi3Error; *s = malloc(n); memcpy(*s, b, n); return fmi3OK; }
