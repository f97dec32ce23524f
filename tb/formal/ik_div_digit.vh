// SPDX-License-Identifier: Apache-2.0
// Appended to ik_div_digit: the quotient after every row is right, at full width. A linear ghost replaces the product.
// No assumptions: operands are arbitrary in every clock, and the first state is arbitrary.
//
// Ghosts travel with the operands: the magnitude M, the divisor d, P and Q. A row computes P <= 2 P + q d and
// Q <= 2 Q + q from P = Q = 0. So P = Q d, as `floors` proves, without a multiplier in this formula. After n rows,
// P + R == M >> (ROWS - n) and 0 <= R < d, and the word holds Q and M's remaining bits. R is r if r >= 0, else r + d;
// -d <= r < d.

reg [LAT-1:0] f_valid = {LAT{1'b0}};  // bit i: operands behind i+1 registers entered after the first clock
always @(posedge clk) f_valid <= {f_valid[LAT-2:0], 1'b1};

reg f_sign_1;
reg [DW-1:0] f_d_1;  // the divisor with its sign
reg [XW-1:0] f_M_1;
wire signed [XW-1:0] f_n = n;
wire signed [XW-1:0] f_N = f_n <<< SH;
always @(posedge clk) begin
  f_sign_1 <= n[NW-1];
  f_d_1 <= d;
  f_M_1 <= n[NW-1] ? (-1 - f_N) : f_N;
end
// The quotient fits in ROWS bits if d > 0 and M < d 2^ROWS.
wire [XW+DW-1:0] f_d_wide = f_d_1;
wire [XW+DW-1:0] f_M_wide = f_M_1;
wire f_over_1 = f_d_1[DW-1] || (f_M_wide >= (f_d_wide << ROWS));
localparam [XW-1:0] LOW = (1 << (ROWS - STORED)) - 1;  // mask: bits of the magnitude that copy the sign

always @* if (f_valid[0]) begin
  first_flags : assert (over_1 == f_over_1 && sign_1 == f_sign_1);
  first_divisor : assert (d_1 == f_d_1[DW-2:0]);
  first_remainder : assert (f_over_1 || (r_1 < d_1 && r_1 == f_M_1 >> ROWS));
  first_word : assert (STORED == 0 || word_1 == f_M_1[ROWS-1:ROWS-FIRST]);
  first_copies : assert ((f_M_1 & LOW) == (f_sign_1 ? LOW : 0));
end

(* hierconn *) wire [STAGES-1:0] \u_over.genblk1.genblk1.g_line.line ;

generate
  for (k = 0; k < ROWS; k = k + 1) begin : g_slice
    localparam integer CLOCKS = (BITS == 1 || k % 2 == 1 || k == ROWS - 1) ? 1 : 0;
    localparam integer STAGE = (BITS == 1) ? (k + 1) : (k / 2 + 1);
    localparam integer NEXT = (k + 1 > FIRST) ? (k + 1) : FIRST;
    localparam integer COME = (k + 1 < STORED) ? (STORED - k - 1) : 0;  // stored bits not used yet
    wire sign;
    wire over_in;
    wire [DW-2:0] dv;
    wire [XW-1:0] M;
    wire [XW-1:0] P;
    wire [ROWS-1:0] Q;
    if (k == 0) begin : g_first
      assign {sign, over_in, dv, M, P, Q} = {f_sign_1, f_over_1, f_d_1[DW-2:0], f_M_1, {XW{1'b0}}, {ROWS{1'b0}}};
    end else begin : g_next
      assign {sign, over_in, dv, M, P, Q} = {
        g_slice[k-1].sign_q, g_slice[k-1].over_q, g_slice[k-1].dv_q, g_slice[k-1].M_q, g_slice[k-1].P_q,
        g_slice[k-1].Q_q
      };
    end
    wire bit_q = g_row[k].q_bit;
    wire [XW-1:0] P_next = (P << 1) + (bit_q ? dv : {(DW - 1) {1'b0}});
    wire [ROWS-1:0] Q_next = {Q[ROWS-2:0], bit_q};
    reg sign_q;
    reg over_q;
    reg [DW-2:0] dv_q;
    reg [XW-1:0] M_q;
    reg [XW-1:0] P_q;
    reg [ROWS-1:0] Q_q;
    if (CLOCKS == 1) begin : g_clocked
      always @(posedge clk) {sign_q, over_q, dv_q, M_q, P_q, Q_q} <= {sign, over_in, dv, M, P_next, Q_next};
    end else begin : g_through
      always @* {sign_q, over_q, dv_q, M_q, P_q, Q_q} = {sign, over_in, dv, M, P_next, Q_next};
    end
    wire [NEXT-1:0] word = g_row[k].word_q;
    wire [NEXT-1:0] word_of_Q = Q_q;
    wire [NEXT-1:0] word_to_come = (COME > 0) ? ((M_q >> (ROWS - STORED)) << (k + 1)) : 0;
    // r is negative if bit 0 of the word is 0; then r = r_q - 2^(DW-1), R = r + d; a carry in r_q + d means R >= 0.
    wire ge = word[0];
    wire [DW-1:0] r_plus = {1'b0, g_row[k].r_q} + {1'b0, ge ? {(DW - 1) {1'b0}} : g_row[k].divisor_q};
    wire [DW-2:0] R = r_plus[DW-2:0];
    ik_checks u (
        .on(f_valid[STAGE] || (CLOCKS == 0 && f_valid[STAGE-1])),
        .in_range((over_q || (R < g_row[k].divisor_q && r_plus[DW-1] == !ge)) && (Q_q >> (k + 1)) == 0),
        .identity(over_q || P_q + R == M_q >> (ROWS - 1 - k)),
        .to_come((CLOCKS == 0 || \u_over.genblk1.genblk1.g_line.line [STAGE-1] == over_q) &&
            g_row[k].sign_q == sign_q && g_row[k].divisor_q == dv_q && (M_q & LOW) == (sign_q ? LOW : 0)),
        .result(word == (word_of_Q | word_to_come))
    );
  end
endgenerate

// ---- behind the rows: overflow and sign ----

wire f_over_rows = g_slice[ROWS-1].over_q;
wire f_sign_rows = g_slice[ROWS-1].sign_q;
wire [QW-1:0] f_Q_rows = g_slice[ROWS-1].Q_q;
wire [QW-1:0] f_largest = {1'b0, {(QW - 1) {1'b1}}};
wire [QW-1:0] f_magnitude = f_over_rows ? f_largest : f_Q_rows;
localparam integer BEHIND = LAT - 1 - STAGES;  // registers behind the rows; this file needs at least two
(* hierconn *) wire [(QW+1)*BEHIND-1:0] \u_out.genblk1.genblk1.g_line.line ;
reg [(QW+1)*BEHIND-1:0] f_out;  // expected content of these registers
always @(posedge clk)
  f_out <= {f_out[(QW+1)*(BEHIND-1)-1:0], f_over_rows, f_sign_rows ? ~f_magnitude : f_magnitude};
wire [BEHIND-1:0] f_row_out;
generate
  for (k = 0; k < BEHIND; k = k + 1) begin : g_out
    assign f_row_out[k] = !f_valid[STAGES+1+k] ||
        \u_out.genblk1.genblk1.g_line.line [(QW+1)*k+:QW+1] == f_out[(QW+1)*k+:QW+1];
  end
endgenerate
always @* begin
  if (f_valid[STAGES]) over_arrives : assert (over == f_over_rows);
  out_line : assert (&f_row_out);
  if (f_valid[LAT-1]) sign_and_bound : assert ({ovf, q} == f_out[(QW+1)*BEHIND-1-:QW+1]);
end

// ---- covers ----

always @* if (f_valid[LAT-1]) begin
  exact : cover (!ovf && q != 0 && !q[QW-1]);
  negative : cover (!ovf && q[QW-1]);
  too_large : cover (ovf && !q[QW-1]);
  too_small : cover (ovf && q[QW-1]);
end

`ifdef IK_COVER
// A single path, so that the search has no choices: these operands, one after the other.
reg [1:0] f_clock = 2'd0;
always @(posedge clk) f_clock <= f_clock + 1'b1;
wire [NW-1:0] f_n_is = f_clock[0] ? -12345 : 12345;
wire [DW-1:0] f_d_is = f_clock[1] ? (1 << (DW - 2)) : 0;
always @* assume (n == f_n_is && d == f_d_is);
`endif
