    // Read inside nurbs_interpolator, by its proof.
    always @* if (!rst) begin
        assert (!(busy && (go || load)));
        assert ({2'b00, go} + {2'b00, forget} + {2'b00, stop} + {2'b00, load} <= 3'd1);
        cover (go && complete);
        cover (stop && busy);
        cover (forget && busy);
    end
